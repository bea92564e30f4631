"""Questions about robots in formation: what a study's Dataset says of estimators, plants and readings."""

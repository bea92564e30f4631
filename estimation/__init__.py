"""What a robot believes: errors and estimators on arrays, with no simulator inside."""

"""One file per question: `formation` of studies, `estimators` and `vehicle` of those alone.

Comes in: a question, its answer as data, table and JSON. Its figures belong to `figures`, its options to `commands`.
"""

"""One page of HTML that tells a study: figures, tables, film and all that it takes to repeat it.

Comes in: what only the page needs.
"""

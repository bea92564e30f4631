from hypothesis import settings

# The same examples at every run, and no time limit on a shared machine.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")

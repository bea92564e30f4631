from dynabot_mj.study import configuration
from dynabot_mj.study.assembly import simulate
from dynabot_mj.study.scenario import Case


def case(plant, estimator, perception="gauss-markov"):
    return Case(plant=plant, estimator=estimator, perception=None if estimator == "perfect" else perception)


def run(plant, estimator, numbers, recorded=0, perception="gauss-markov", **options):
    setup = configuration.build({"plants": [plant]}, **options)
    return simulate(setup, case(plant, estimator, perception), numbers, recorded=recorded)

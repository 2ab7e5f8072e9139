"""Scores of diagnoses against what was injected, for cases of motion and of light."""


def score_case(case, diagnosis, oracle):
    """The CaseScore of a case's folder, from diagnosis.json in `diagnosis` and, where there is one, in `oracle`."""


def questions(scores):
    """The headline counts: rows of (question, Fraction, aim)."""


def figures(scores):
    """Pulls, held-out errors, calibration and times: {name: (value, standard error)}."""

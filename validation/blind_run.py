"""One case diagnosed by the installed program in a folder that holds nothing but what a user would have."""


def run_child(program, arguments, folder, longest_s):
    """Result(status, processor_s, errors) of another program, stopped after longest_s of CPU time."""


def diagnose_blind(case, experiment, blind, how):
    """Diagnoses `experiment` (a file of the folder `case`) in the folder `blind`, and leaves there
    diagnosis/, diagnosis/runs.json and error.txt, and how well improved.toml repeats the recording."""

"""Cases as folders: experiment, recordings, and the truth of what was injected (truth.json).

A case has experiment.toml, run1.csv.gz and run2.csv.gz (or the files that the lists `recordings` and
`holdouts` of the truth name), oracle.toml (the experiment with the injected effects and their true
numbers), truth1.toml and truth2.toml (every number true, and the start of each run) and truth.json,
which is written last: a folder that has one is complete.
"""


def is_case(folder):
    """Whether a folder holds a truth."""


def files_of_case(folder):
    """CaseFiles(recordings, holdouts, of_light) of a case's folder."""


def cases_in(folder):
    """The cases in a folder, by name. InputError where there is none, or a file of one is missing."""


def write_file(path, data):
    """Writes text or bytes whole: under another name first; makes the folder."""


def write_gzip(path, text):
    """Writes a text compressed, with the same bytes every time."""

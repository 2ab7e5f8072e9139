"""Tables of scores: CSV, JSON and the marked sections of docs/proof.md and docs/light_diagnosis.md."""


def markdown(title, description, scores):
    """The section of a document."""


def with_section(document, name, text, file):
    """`document` with the text between <!-- NAME begin --> and <!-- NAME end --> replaced."""

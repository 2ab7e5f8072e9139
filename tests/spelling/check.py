"""Spelling of documents, comments and messages in all tracked files: British English by hunspell, and words.txt.

    check.py SOURCE_FOLDER [--list]     # --list prints unknown words only, one a line, as words.txt has them

Names in backquotes, code in documents and generated tables are not texts, nor are strings of tests and strings
without a blank. Exit status 77 (skipped) without hunspell, its dictionary or git.
"""

import pathlib
import re
import shutil
import subprocess
import sys

DATA = ("tests/data/", "tests/fuzz/corpus/", "tests/fuzz/seeds/", "images/browser/script/page.min.js")
# Words of other languages, not texts.
TABLES_OF_WORDS = ("diagnosis/guess/header.cpp", "diagnosis/guess/meanings.cpp",
                   "diagnosis/guess/meanings.h", "diagnosis/guess/names.cpp", "photovoltaics/fit/curve_words.cpp")
MARKS = {".h": "//", ".cpp": "//", ".js": "//"} | dict.fromkeys((".py", ".pyi", ".toml", ".cmake", ".sh", ".zsh"), "#")
# A word of a text: letters that are not part of a name, path, key, call or unit.
WORD = re.compile(r"(?<![\w/.\\%$@\-])[A-Za-z][a-z']+[a-z](?![\w/(\[=]|\.\w|::|->|'\w)")


def text_of_document(document):
    for code in (r"```.*?```", r"<!--.*?-->", r"(?m)^    .*$", r"`[^`\n]*`", r"\]\([^)]*\)", r"\S+://\S+"):
        document = re.sub(code, " ", document, flags=re.S)
    return document


def text_of_code(code, mark, strings):
    comments = re.findall(r"(?:^|\s)" + mark + r"+(?!!)(.*)", code)
    quoted = re.findall(r'"((?:[^"\\\n]|\\.)*)"', code) if strings else []
    messages = [re.sub(r"\\.", " ", text) for text in quoted if " " in text and not re.search(r"[<{;$]|--", text)]
    return re.sub(r"`[^`]*`|\S+://\S+|'[^' ]*'", " ", "\n".join(comments + messages))


def text_of(path, content):
    suffix = pathlib.PurePath(path).suffix
    if suffix == ".md":
        return text_of_document(content)
    mark = MARKS.get(suffix) or ("#" if path.endswith("CMakeLists.txt") or re.match(r"tools/[\w/]+$", path) else "")
    return text_of_code(content, mark, not path.startswith("tests/")) if mark else ""


def unknown(words):
    """Those of `words` that hunspell's dictionary of British English lacks."""
    listed = subprocess.run(["hunspell", "-d", "en_GB", "-i", "utf-8", "-l"], input="\n".join(sorted(words)),
                            capture_output=True, text=True, check=True)
    return set(listed.stdout.split())


def main():
    root = pathlib.Path(sys.argv[1])
    if not shutil.which("hunspell") or subprocess.run(["hunspell", "-d", "en_GB", "-l"], input="", text=True,
                                                      capture_output=True).returncode:
        print("skipped: hunspell or hunspell-en-gb is missing (tools/install --tests)")
        return 77
    tracked = subprocess.run(["git", "-C", root, "-c", f"safe.directory={root.resolve()}", "ls-files"],
                             capture_output=True, text=True)
    if tracked.returncode:
        print("skipped: the tree is no git repository")
        return 77
    places = {}
    for path in tracked.stdout.split("\n"):
        if path.startswith(DATA) or path in TABLES_OF_WORDS or not (root / path).is_file():
            continue
        try:
            content = (root / path).read_text()
        except UnicodeDecodeError:
            continue
        for word in WORD.findall(text_of(path, content)):
            places.setdefault(word.removesuffix("'s"), path)
    own = {word for word in (root / "tests/spelling/words.txt").read_text().split("\n") if not word.startswith("#")}
    wrong = sorted(unknown(places.keys() - own))
    if sys.argv[2:] == ["--list"]:
        print("\n".join(wrong))
        return 0
    # A misspelt word must be found, or nothing was compared.
    if "aray" not in unknown({"array", "aray"}) or len(places) < 5000:
        print(f"hunspell finds no misspelt word, or too few words were read ({len(places)})")
        return 1
    for word in wrong:
        print(f"{places[word]}: {word}: correct it, or add it to tests/spelling/words.txt")
    print(f"{len(places)} words, {len(wrong)} unknown")
    return 1 if wrong else 0


sys.exit(main())

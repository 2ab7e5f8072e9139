"""The examples of docs/python.md run as they stand."""

import os
import re
import unittest

from support import FolderTest, source


class Documents(FolderTest):
    def test_examples(self):
        text = (source / "docs" / "python.md").read_text()
        examples = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
        self.assertGreaterEqual(len(examples), 2)
        self.assertLessEqual(len(examples[0].strip().splitlines()), 10)
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(source)
        names = {}
        for example in examples:
            exec(compile(example.replace('"out/', f'"{self.folder}/'), "docs/python.md", "exec"), names)

#!/usr/bin/python3
"""Every rule that ablate.py switches off is still in the sources, once. Exit code 77 where numpy is not installed."""
import re
import sys
import unittest

try:
    import ablate
except ImportError:
    sys.exit(77)

SOURCES = ablate.ROOT / "src" / "bespoke"


class Rules(unittest.TestCase):
    def test_texts_stand_once(self):
        for rule in ablate.RULES:
            if rule.file:
                with self.subTest(rule.name):
                    self.assertEqual((SOURCES / rule.file).read_text().count(rule.old), 1)

    def test_constants_exist(self):
        settings = (SOURCES / ablate.SETTINGS).read_text()
        for rule in ablate.RULES:
            for name in rule.values:
                with self.subTest(rule.name, constant=name):
                    place, member = name.split(".")  # a struct of the settings, or a source's name
                    body = re.search(rf"struct {place} {{.*?\n}};", settings, re.S)
                    text = body[0] if body else "".join(path.read_text() for path in SOURCES.rglob(place + ".cpp"))
                    self.assertRegex(text, rf"\b{member}\b")

    def test_names_differ(self):
        names = [rule.name for rule in ablate.RULES]
        self.assertEqual(len(names), len(set(names)))


class Varied(unittest.TestCase):
    def test_each_constant_goes_either_way(self):
        constants = {"a.count": 3.0, "a.length": 0.1, "a.cosine": 0.9, "a.none": 0.0, "a.is_on": True}
        self.assertEqual([(name, round(new, 9)) for name, _, new in ablate.varied(constants, 2)],
                         [("a.count", 6), ("a.length", 0.2), ("a.cosine", 0.95),
                          ("a.count", 2), ("a.length", 0.05), ("a.cosine", 0.8)])


if __name__ == "__main__":
    unittest.main()

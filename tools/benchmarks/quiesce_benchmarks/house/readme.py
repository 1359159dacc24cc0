"""How long a page is, as a reader sees it.

Counted is the visible text outside of code blocks: headings, prose, tables, code in backticks. Left
out are fenced code blocks, HTML comments, and where links and pictures lead to (their words count).
A word is what stands between spaces and holds a letter or a digit. A number is a word with a digit
in it, whatever it is: a measured value, a version, the name of a standard or of a processor.
"""

import re

FENCED = re.compile(r"^```.*?^```[^\n]*$", re.MULTILINE | re.DOTALL)
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
LINK_TARGET = re.compile(r"\]\([^)]*\)")


def visible(text: str) -> str:
    for pattern, left in ((FENCED, ""), (COMMENT, ""), (LINK_TARGET, "]")):
        text = pattern.sub(left, text)
    return text


def words(text: str) -> list[str]:
    return [word for word in visible(text).split() if re.search(r"\w", word)]


def readme_words(text: str) -> int:
    return len(words(text))


def readme_numbers(text: str) -> int:
    return sum(1 for word in words(text) if re.search(r"\d", word))

"""Names that generated C may give to what it defines."""

import re

# Keywords of C and C++ that nothing can have for its name.
RESERVED = frozenset(
    "alignas alignof and asm auto bool break case catch char class const constexpr continue "
    "default delete do double else enum explicit export extern false float for friend goto if "
    "inline int long main mutable namespace new noexcept not nullptr operator or private "
    "protected public register restrict return short signed sizeof static static_assert "
    "struct switch template this throw true try typedef typeid typename union unsigned using "
    "virtual void volatile wchar_t while xor".split()
)


def is_c_name(name: str) -> bool:
    return re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) is not None and name not in RESERVED

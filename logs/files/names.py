"""Names that control systems and historians give to SP, PV, OP, MV, the stem position and MODE."""

from __future__ import annotations

import re
from functools import lru_cache

__all__ = ["ROLES", "numbers_in", "plain", "role_of", "same_numbers"]

# Names without case, spaces and punctuation. STEM is a position by its own name; MV is ambiguous: the
# literature calls the stem position so, some products the controller output.
ROLES = {
    "SP": (
        "sp", "spt", "setpoint", "setpt", "setp", "setpointvalue", "sv", "setvalue", "wsp", "spvalue", "set",
        "reference", "ref", "r", "target", "spv", "spwrk", "currentsp", "spout", "workingsetpoint", "sollwert",
        "consigne", "consigna", "settpunkt", "börvärde", "setpunkt", "spint", "spcur",
    ),
    "PV": (
        "pv", "processvalue", "processvariable", "processvar", "procval", "measurement", "meas", "measuredvalue",
        "measured", "y", "pvvalue", "pvin", "actualvalue", "pvcurrent", "controlledvariable", "pvout", "istwert",
        "mesure", "medida", "måleverdi", "ärvärde", "prosessverdi", "medición",
    ),
    "OP": (
        "op", "out", "output", "co", "cout", "controlleroutput", "controloutput", "ctrlout", "controllerout",
        "opvalue", "u", "outvalue", "controlsignal", "outputvalue", "lmn", "cvout", "demand", "command", "cmd",
        "valvecommand", "controlout", "valvedemand", "outputpercent", "stellwert", "stellgröße", "stellgroesse",
        "stellgrösse", "sortie", "salida", "pådrag", "utsignal",
    ),
    "MV": ("mv", "manipulatedvariable", "manipulatedvalue", "manipvar"),
    "STEM": (
        "stem", "stemposition", "valveposition", "position", "pos", "travel", "valvetravel", "vp", "zt", "zi",
        "feedback", "positionfeedback", "actualposition", "valvepos", "stempos", "lift", "valvefeedback",
        "positionerfeedback", "mvposition", "fbk", "fdbk", "rbk", "readback", "posfb", "posfbk", "positionfbk",
        "positionreadback", "mvrbk", "mvreadback", "actpos", "posact", "zpv", "valveopening", "ventilstellung",
        "stellungsrückmeldung", "rückmeldung", "ventilposisjon", "ventilläge", "positionfeedbackvalue",
    ),
    "MODE": ("mode", "md", "actmode", "modeactual", "modeact", "actualmode", "controllermode", "loopmode",
             "controlmode", "modeactualmode", "betriebsart", "modus", "modo"),
}  # fmt: skip
_ROLE_BY_NAME = {name: role for role, names in ROLES.items() for name in names}
_LETTERS_ALONE = {"r", "y", "u", "ref", "pos", "target", "command", "demand", "md", "measured", "position", "set"}
_BEHIND_A_TAG = {"pos", "position", "set", "demand", "command"}
_NOISE = {"cv", "val", "value", "fcv", "act", "actual", "pida", "pid", "pid1a", "read", "current", "last"}
_SUFFIX = re.compile(r"^(?P<loop>.*\d[A-Za-z]?)(?P<role>pv|sp|op|co|mv|out|mode)$", re.IGNORECASE)
_WORD = re.compile(r"[^\s._/\\:|#\-]+")
# ISA-5.1: first letter Z is a position, so the measurement of ZT101 is where the valve stands.
_POSITION = re.compile(r"^(.*[^A-Za-z])?Z[IT]{1,2}[-_ ]?\d+[A-Za-z]?$", re.IGNORECASE)


@lru_cache(maxsize=10_000)  # a file asks many times for each of its columns
def role_of(column: str) -> tuple[str, str] | None:
    """Loop and role ("SP", "PV", "OP", "MV", "STEM", "MODE") that a column name tells, None if none.

    >>> [role_of(name) for name in ("FIC211.PIDA.OP", "PID1/OUT.CV", "FIC-211 Sp", "TIC_1203A_PV")]
    [('FIC211', 'OP'), ('PID1', 'OP'), ('FIC-211', 'SP'), ('TIC_1203A', 'PV')]
    >>> role_of("Controller Output"), role_of("PV FIC211"), role_of("flow_t_h")
    (('', 'OP'), ('FIC211', 'PV'), None)
    >>> role_of("FV211.POS"), role_of("ZT-211.PV"), role_of("ZI211")
    (('FV211', 'STEM'), ('ZT-211', 'STEM'), ('ZI211', 'STEM'))
    """
    known = _by_words(column) or _by_words(column.partition(" - ")[0])  # "FIC211.PV - Feed flow"
    tag = known[0] if known and known[1] == "PV" else "" if known else _loop_part(column)
    if _POSITION.match(tag):
        return tag, "STEM"
    return known


def _by_words(column: str) -> tuple[str, str] | None:
    pieces = [(found.start(), found.group()) for found in _WORD.finditer(column)]
    words = [word.casefold() for _, word in pieces]
    end = len(words)
    while end:
        for first in range(max(0, end - 3), end):
            before = column[: pieces[first][0]]
            role = _role("".join(words[first:end]), alone=first == 0, tagged=any(char.isdigit() for char in before))
            if role:
                if role == "MODE" and words[-1] in {"target", "normal", "permitted"}:
                    return None
                return _loop_part(before), role
        if words[end - 1] not in _NOISE or end == 1:
            break
        end -= 1
    if len(words) > 1:  # the role in front: "PV FIC211", "OP_FIC211"
        role = _role(words[0], alone=False)
        if role and any(char.isdigit() for char in column[pieces[1][0] :]):
            return _loop_part(column[pieces[1][0] :]), role
    run_on = _SUFFIX.match(column.strip())
    if run_on:
        return _loop_part(run_on["loop"]), _ROLE_BY_NAME[run_on["role"].casefold()]
    return None


def _role(word: str, *, alone: bool, tagged: bool = False) -> str | None:
    if word in _LETTERS_ALONE and not alone and not (tagged and word in _BEHIND_A_TAG):
        return None
    return _ROLE_BY_NAME.get(word)


def _loop_part(text: str) -> str:
    """The loop in what is left of a name: without punctuation at the ends and without noise words."""
    text = text.strip(" ._/\\:|#-'\"")
    pieces = re.split(r"[._/\\:|#\s]+", text)
    while len(pieces) > 1 and pieces[-1].casefold() in _NOISE:
        text = text[: -len(pieces.pop())].rstrip(" ._/\\:|#-")
    return text


def numbers_in(name: str) -> tuple[str, ...]:
    """The numbers in a tag, the last of which a loop's instruments share: 211 in FIC211 and ZT-211.

    >>> numbers_in("12-FIC-211"), numbers_in("FV1203a/POS"), numbers_in("stem")
    (('12', '211'), ('1203a',), ())
    """
    return tuple(found.casefold().lstrip("0") for found in re.findall(r"\d+[A-Za-z]?(?![A-Za-z\d])|\d+", name))


def same_numbers(one: tuple[str, ...], other: tuple[str, ...]) -> bool:
    """Whether two tags have the same number, and the same area before it where both tell one.

    >>> same_numbers(("12", "211"), ("211",)), same_numbers(("12", "211"), ("13", "211"))
    (True, False)
    """
    both = min(len(one), len(other))
    return both > 0 and one[-both:] == other[-both:]


def plain(name: str) -> str:
    """A name without case, spaces and punctuation."""
    return re.sub(r"[^a-z0-9]", "", name.casefold())

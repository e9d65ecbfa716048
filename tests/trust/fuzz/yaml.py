"""Presets: damaged ones, hostile ones, and ones made after the schema, through the loader."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from math import isfinite
from random import Random
from typing import Any

from slidetune.robot.errors import SlidetuneError
from slidetune.robot.experiment.document import Experiment
from slidetune.robot.experiment.plain_yaml import LARGEST_TEXT
from slidetune.robot.experiment.preset_yaml import experiment_from_yaml, experiment_to_yaml
from slidetune.robot.experiment.presets import SHIPPED_FOLDER
from tests.trust.fuzz.values import BAD_JSON, RAW_NUMBERS, TEXTS, Instances, json_text
from tests.trust.fuzz.verdict import crash, unclear

NAMES = ("A", "NFTSM", "RBFNN-NFTSM", "ν = 0.5", "a.b", 'a "b"', "nftsm", "null", "12")
TOKENS = (
    *RAW_NUMBERS, *BAD_JSON[:14], "~", "null", "yes", "off", "010", "0o17", "1:30", "1:30:30",
    ".inf",
    ".nan", "-.INF", "1e3", "&a 1", "*a", "!!python/object:os.system ls", "!!python/name:eval",
    "!!float 1", "!!binary R0lG", "!x 1", "<<: *a", "{<<: {nu: 1}}", "'one", '"two', '"\\x07"',
    '"\\ud800"', '"\\U00110000"', "|", ">-", "|9", "? a", "- - -", "%YAML 1.1", "---", "...", "#",
    "@x",
    "`x`", "{a: [b, {c: d}]}", "{", "]", "1 2", "a: b", "2001-01-01", "=", "\t1", "x" * 5000, "",
)  # fmt: skip
BYTES = (
    b"\xff", b"\xfe\xff", b"\xef\xbb\xbf", b"\x00", b"\x1b[31m", b"\xc0\xaf", b"\xed\xa0\x80",
    b"\t", b"\r",
    b"\n", b"\xc2\x85", b"\xe2\x80\xa8", b": ", b"- ", b"? ", b"&a ", b"*a ", b"!!", b"<<: ",
    b"{", b"}",
    b"[", b"]", b"|\n", b">\n", b"'", b'"', b"#", b"%", b"---\n", b"...\n", b"\xf4\x90\x80\x80",
)  # fmt: skip


@lru_cache(maxsize=1)
def _seeds() -> tuple[bytes, ...]:
    """Return the shipped presets, whole and without comments (which are quicker to read)."""
    texts = [path.read_text("utf-8") for path in sorted(SHIPPED_FOLDER.glob("*.yaml"))]
    bare = [re.sub(r" *#.*", "", text) for text in texts]
    short = [re.sub(r"(?s)description: \|.*?\nrobot:", "robot:", text) for text in bare]
    small = "slidetune: 1\ntitle: two\nlanes:\n  A: {law: nftsm, nu: [1, 2, 3, 4, 5, 6]}\n  B:\n"
    small += "    law: smc\n    k1: 20.5\ntrajectory: {kind: hold}\nsimulation: {horizon: 2}\n"
    kept = [re.sub(r"\n\s*\n", "\n", text) for text in short]
    return tuple(text.encode() for text in (*texts[:1], *kept, *[small] * 12))


@lru_cache(maxsize=1)
def instances() -> Instances:
    """Return what makes experiments after their own schema."""
    schema = Experiment.model_json_schema()
    return Instances(schema, schema, NAMES)


def _bit_flips(text: bytearray, random: Random) -> None:
    for _ in range(random.choice((1, 1, 2, 8))):
        text[random.randrange(len(text))] ^= 1 << random.randrange(8)


def _cut(text: bytearray, random: Random) -> None:
    start = random.randrange(len(text))
    del text[start : start + random.choice((1, 2, 10, len(text)))]


def _insert(text: bytearray, random: Random) -> None:
    place = random.randrange(len(text) + 1)
    text[place:place] = random.choice(BYTES) * random.choice((1, 1, 1, 3))


def _lines(text: bytearray, random: Random) -> None:
    lines = text.split(b"\n")
    first, second = random.randrange(len(lines)), random.randrange(len(lines))
    if random.random() < 0.5:
        lines[first], lines[second] = lines[second], lines[first]
    else:
        lines.insert(second, lines[first])
    text[:] = b"\n".join(lines)


def _indent(text: bytearray, random: Random) -> None:
    lines = text.split(b"\n")
    place = random.randrange(len(lines))
    lines[place] = random.choice((b" ", b"  ", b"\t", b"- ")) + lines[place].lstrip()
    text[:] = b"\n".join(lines)


def _value(text: bytearray, random: Random) -> None:
    places = list(re.finditer(rb"(?<=: )[^\s\[{][^\n]*|(?<=[\[,] )[^\],\n]+", text))
    if places:
        place = random.choice(places)
        text[place.start() : place.end()] = random.choice(TOKENS).encode("utf-8", "replace")


_DAMAGES: tuple[Callable[[bytearray, Random], None], ...] = (
    _bit_flips, _cut, _insert, _lines, _indent, _value, _value, _value,
)  # fmt: skip


def _damaged(random: Random) -> bytes:
    text = bytearray(random.choice(_seeds()))
    for _ in range(random.choice((1, 1, 1, 2, 4))):
        random.choice(_DAMAGES)(text, random)
        text = text or bytearray(b"\n")
    return bytes(text)


def _scalar(value: Any, random: Random) -> str:
    if random.random() < 0.05:
        return random.choice(TOKENS)
    if isinstance(value, float) and not isfinite(value):
        return random.choice((".inf", "-.inf", ".nan"))
    return json_text(value)


def _block(value: Any, random: Random, level: int = 0) -> str:
    """Return a value in YAML's block style, or here and there in flow style."""
    if level > 20 or not isinstance(value, dict) or not value or random.random() < 0.1:
        return _scalar(value, random)
    keys = [json_text(k) if random.random() < 0.5 else str(k).replace("\n", "") for k in value]
    pad = "  " * level
    parts = (_block(item, random, level + 1) for item in value.values())
    return "".join(f"\n{pad}{key}: {part}" for key, part in zip(keys, parts, strict=True))


def _made(random: Random) -> bytes:
    value = instances().make(random, random.choice((0.0, 0.02, 0.1)))
    try:
        text = _block(value, random) if random.random() < 0.5 else json_text(value)
    except RecursionError:
        text = "a: " * 3000
    return text.encode("utf-8", random.choice(("replace", "surrogatepass")))


def _hostile(random: Random) -> bytes:
    number = random.choice((1, 13, 500, 20_000, 100_000))
    token, text = random.choice(TOKENS), random.choice(TEXTS)
    laughs = "a0: &a0 [x, x]\n" + "".join(
        f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 30)
    )
    choices = (
        laughs, "[" * number, "{a: " * number, "- " * number, "? " * number, "a:\n" * number,
        f"title: {token}\n", f"{token}: 1\n", f"lanes: {{A: {{law: {token}}}}}\n",
        f"lanes:\n  A:\n    law: nftsm\n    nu: {token}\n", f"robot: {{torque_limit: {token}}}",
        f"slidetune: {token}", f"title: {json_text(text)}\n{json_text(text)}: 1", f"title: {text}",
        f"lanes: {{{json_text(text)}: {{law: smc}}}}", f"title: '{'a' * number}'",
        "robot: &r {armature: 1}\nsimulation:\n  <<: *r\n", "\n" * number + "title: 1:2:3",
        "".join(f"k{i}: {i}\n" for i in range(number // 20)), f"# {'c' * number}\ntitle: x\n",
        f"lanes: {{{', '.join(f'L{i}: {{law: smc}}' for i in range(number % 20 + 1))}}}",
        f"disturbance: {{seed: {'9' * number}}}", f"title: !<{'t' * number}> x", "a: b: c",
        f"description: |\n  {json_text(text)}\n  x\n", f"\ufefftitle: {token}",
        f"--- {token}\n...\n",
    )  # fmt: skip
    made = random.choice(choices).encode("utf-8", "replace")
    if random.random() < 0.15:
        place = random.randrange(len(made) + 1)
        made = made[:place] + random.choice(BYTES) + made[place:]
    return made


def _encoded(random: Random) -> bytes:
    text = random.choice(_seeds()).decode() + "# ä\n"
    encoding = random.choice(("utf-16", "utf-32", "latin-1", "utf-8-sig", "cp037"))
    return text.encode(encoding, "replace")


def yaml_input(random: Random) -> bytes:
    """Return one text that a preset's file might hold."""
    kinds = (_damaged, _made, _hostile, _encoded)
    return random.choices(kinds, (50, 30, 18, 2))[0](random)


def judge_yaml(text: bytes) -> tuple[bool, tuple[str, str] | None]:
    """Read a text; return whether it was taken, and the cause and detail of a fault."""
    try:
        experiment = experiment_from_yaml(text)
    except SlidetuneError as error:
        fields = [vars(one) for one in getattr(error, "fields", ())]
        cause = unclear(str(error), fields, text.decode("utf-8", "replace"))
        return False, None if cause is None else (cause, str(error)[:300])
    except Exception as error:
        return False, crash(error)
    return True, unequal(experiment)


def unequal(experiment: Experiment) -> tuple[str, str] | None:
    """Return cause and detail if an experiment doesn't come back from its YAML as it was."""
    try:
        text = experiment_to_yaml(experiment)
        if len(text.encode()) > LARGEST_TEXT:
            return "written larger than what is read", f"{len(text)} characters"
        if experiment_from_yaml(text) != experiment:
            return "comes back changed", text[:300]
    except Exception as error:
        return f"can't be written and read: {crash(error)[0]}", crash(error)[1]
    return None


def smaller(text: bytes, cause: str) -> bytes:
    """Return a shorter text with the same fault, found by cutting pieces out."""
    size, tries = len(text) // 2, 0
    while size and tries < 400:
        start = 0
        while start < len(text) and tries < 400:
            shorter, tries = text[:start] + text[start + size :], tries + 1
            complaint = judge_yaml(shorter)[1]
            if complaint is not None and complaint[0] == cause:
                text = shorter
            else:
                start += size
        size //= 2
    return text

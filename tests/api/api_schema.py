"""Holds every answer of a daemon against openapi.json: its status, its kind, its body."""
import json
import re
from functools import lru_cache
from pathlib import Path

import jsonschema

API = json.loads((Path(__file__).parents[2] / "server" / "http" / "openapi.json").read_text())
ROOT = "/api/v1"


def pattern_of(path):
    """{path} of an artifact takes the rest of the address, every other {name} one segment."""
    spelled = re.sub(r"\{(\w+)\}", lambda m: ".+" if path.endswith("/artifacts/{path}") and m[1] == "path"
                     else "[^/]+", path)
    return re.compile(spelled)


# Without parameters first: /stock/import is no /stock/{id}.
PATHS = sorted(((pattern_of(path), path) for path in API["paths"]), key=lambda each: each[1].count("{"))


def operation_for(method, path):
    path = path.split("?")[0]
    if not path.startswith(ROOT + "/"):
        return None
    for pattern, name in PATHS:
        if pattern.fullmatch(path[len(ROOT):]):
            return API["paths"][name].get(("get" if method == "HEAD" else method).lower())
    return None


def resolved(part):
    while "$ref" in part:
        place = API
        for key in part["$ref"].removeprefix("#/").split("/"):
            place = place[key]
        part = place
    return part


@lru_cache(maxsize=None)
def validator_of(schema_text):
    schema = json.loads(schema_text)
    schema["components"] = API["components"]
    checker = jsonschema.FormatChecker()
    return jsonschema.Draft202012Validator(schema, format_checker=checker)


def problem_of(method, path, status, headers, body):
    """What is wrong with this answer, or None. Answers of unknown paths must be problems."""
    operation = operation_for(method, path)
    kind = (headers.get("Content-Type") or "").split(";")[0]
    where = f"{method} {path} -> {status}"
    if operation is None:
        answers = API["components"]["responses"]["Problem"] if path.startswith(ROOT) and status >= 400 else None
    else:
        answers = operation["responses"].get(str(status)) or (
            operation["responses"].get("default") if status >= 400 else None)
        if answers is None:
            return f"{where}: this status is not described"
    if answers is None:
        return None
    content = resolved(answers).get("content", {})
    if method == "HEAD" or status in (204, 304):
        return f"{where}: has a body" if body else None
    if not content:
        return f"{where}: has a body, and none is described" if body else None
    if kind not in content and "*/*" not in content:
        return f"{where}: is {kind!r}, described are {sorted(content)}"
    if not kind.endswith("json"):
        return None
    schema = content.get(kind, content.get("*/*", {})).get("schema", {})
    try:
        value = json.loads(body)
    except ValueError:
        return f"{where}: is no JSON"
    errors = sorted(validator_of(json.dumps(schema)).iter_errors(value), key=str)
    if errors:
        worst = jsonschema.exceptions.best_match(errors)
        return f"{where}: {'/'.join(map(str, worst.absolute_path))}: {worst.message[:500]}"
    return None

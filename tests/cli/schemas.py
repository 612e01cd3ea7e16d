"""The part of JSON Schema that the schemas under docs use."""
import json
import os
import re

TYPES = {"object": dict, "array": list, "string": str}


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


class Schema(dict):
    """A schema with the definitions of the document it stands in, and that document's folder."""

    def __init__(self, content, root, folder):
        super().__init__(content)
        self.root, self.folder = root, folder

    def inner(self, content):
        """A part of this document, with what it refers to put in its place."""
        if "$ref" not in content:
            return Schema(content, self.root, self.folder)
        file, name = content["$ref"].split("#/$defs/")
        home = read(os.path.join(self.folder, file)) if file else self
        rest = {key: value for key, value in content.items() if key != "$ref"}
        return Schema({**home.inner(home.root["$defs"][name]), **rest}, home.root, home.folder)


def read(path):
    with open(path, encoding="utf-8") as file:
        content = json.load(file)
    return Schema(content, content, os.path.dirname(path))


def faults(value, schema, where="file"):
    """What a schema has against a value; of JSON Schema the words that ours uses, and an error for any other."""
    found = []
    for word, rule in schema.items():
        if word == "type":
            fits = (is_number(value) if rule == "number" else is_number(value) and value == int(value) if rule == "integer"
                    else isinstance(value, TYPES[rule]))
            if not fits:
                return ["%s: not of type %s" % (where, rule)]
        elif word == "const":
            found += [where] if value != rule else []
        elif word == "oneOf":
            found += [where] if sum(not faults(value, schema.inner(option), where) for option in rule) != 1 else []
        elif word == "allOf":
            for option in rule:
                found += faults(value, schema.inner(option), where)
        elif word == "enum":
            found += [where] if value not in rule else []
        elif word == "properties":
            for name in value.keys() & rule.keys():
                found += faults(value[name], schema.inner(rule[name]), where + "." + name)
        elif word == "additionalProperties":
            found += [where + "." + name for name in value.keys() - schema["properties"].keys()]
        elif word == "required":
            found += [where + "." + name for name in rule if name not in value]
        elif word == "items":
            for index, item in enumerate(value):
                found += faults(item, schema.inner(rule), "%s[%d]" % (where, index))
        elif word in ("minimum", "maximum", "exclusiveMinimum"):
            fits = value >= rule if word == "minimum" else value <= rule if word == "maximum" else value > rule
            found += [] if fits else [where]
        elif word in ("minItems", "maxItems", "minLength"):
            found += [] if (len(value) <= rule if word == "maxItems" else len(value) >= rule) else [where]
        elif word == "pattern":
            found += [] if re.search(rule, value) else [where]
        elif word not in ("$schema", "$defs", "title", "description"):
            raise ValueError("schema word %s" % word)
    return found



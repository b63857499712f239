#!/usr/bin/env python3
"""Writes the C++ table of lcmtypes/message_table.h for a set of .lcm files.

usage: lcm_message_table.py FUNCTION OUT.cpp FILE.lcm...     FUNCTION: name of the C++ function that returns the table

Fingerprints come from lcm-gen's own types, so that there is no second computation of them. Exit code 1 and one line for what is
no LCM type definition.
"""
import pathlib
import re
import sys

PRIMITIVES = {"int8_t": "kInt8", "int16_t": "kInt16", "int32_t": "kInt32", "int64_t": "kInt64", "byte": "kByte", "float": "kFloat",
              "double": "kDouble", "boolean": "kBoolean", "string": "kString"}
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)
PACKAGE = re.compile(r"\bpackage\s+([\w.]+)\s*;")
STRUCT = re.compile(r"\bstruct\s+(\w+)\s*\{(.*?)\}", re.S)
NO_MEMBER = re.compile(r"^\s*//.*?$|/\*.*?\*/", re.S | re.M)
CONSTANTS = re.compile(r"\bconst\s+[^;]*;")
MEMBER = re.compile(r"([\w.]+)\s+(\w[^;]*);[ \t]*(?://[ \t]*([^\n]*))?")
NAME = re.compile(r"\s*(\w+)\s*((?:\[\s*\w+\s*\]\s*)*)$")


class DefinitionError(Exception):
    pass


def fields_of(body, package):
    """[(name, type, dimensions, comment)] of a struct's body; "int32_t a, b[3];" are two."""
    fields = []
    for kind, names, comment in MEMBER.findall(CONSTANTS.sub("", NO_MEMBER.sub("", body))):
        for part in names.split(","):
            match = NAME.match(part)
            if not match:
                raise DefinitionError(f"'{part.strip()}' is no field")
            type_name = kind if kind in PRIMITIVES or "." in kind or not package else f"{package}.{kind}"
            fields.append((match.group(1), type_name, re.findall(r"\w+", match.group(2)), comment.strip()))
    return fields


def read(path):
    """{full name: fields} of a file."""
    text = path.read_text(encoding="utf-8")
    bare = COMMENT.sub("", text)
    package = PACKAGE.search(bare)
    package = package.group(1) if package else ""
    structs = STRUCT.findall(text)
    if len(structs) != len(re.findall(r"\bstruct\b", bare)) or not structs:
        raise DefinitionError("no struct, or one that does not end")
    return {f"{package}.{name}" if package else name: fields_of(body, package) for name, body in structs}


def in_order(types):
    """Names, each behind those that it contains."""
    ordered = []

    def add(name, user):
        if name not in types:
            raise DefinitionError(f"{user} has a field of type {name}, which none of the files defines")
        if name in ordered:
            return
        for _, kind, _, _ in types[name]:
            if kind not in PRIMITIVES and kind != name:
                add(kind, name)
        ordered.append(name)

    for name in sorted(types):
        add(name, name)
    return ordered


def quoted(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def identifier(name):
    return name.replace(".", "_")


def dimension(size, names):
    if size.isdigit():
        return f"{{{size}, -1}}"
    if size not in names:
        raise DefinitionError(f"length '{size}' is neither a number nor a field in front of the array")
    return f"{{0, {names.index(size)}}}"


def table_of(name, fields):
    """C++ of one type."""
    this = identifier(name)
    lines, rows, names = [], [], []
    for field, kind, sizes, comment in fields:
        dimensions = "{}"
        if sizes:
            dimensions = f"{this}_{field}"
            lines.append(f"const FieldDimension {dimensions}[] = {{{', '.join(dimension(s, names) for s in sizes)}}};")
        message = "nullptr" if kind in PRIMITIVES else f"&{identifier(kind)}_info"
        rows.append(f"    {{{quoted(field)}, FieldType::{PRIMITIVES.get(kind, 'kMessage')}, {message}, {dimensions}, {quoted(comment)}}},")
        names.append(field)
    members = "{}"
    if rows:
        members = f"{this}_fields"
        lines += [f"const FieldInfo {members}[] = {{", *rows, "};"]
    cpp = name.replace(".", "::")
    lines.append(f"const MessageInfo {this}_info{{{quoted(name)}, ::{cpp}::getHash(), {members}}};")
    return lines


def main():
    function, out, *files = sys.argv[1:]
    types = {}
    try:
        for file in map(pathlib.Path, files):
            try:
                types.update(read(file))
            except DefinitionError as error:
                raise DefinitionError(f"{file}: {error}") from error
        order = in_order(types)
        tables = [line for name in order for line in table_of(name, types[name])]
    except DefinitionError as error:
        print(f"lcm_message_table: error: {error}", file=sys.stderr)
        return 1
    includes = [f"#include <{name.replace('.', '/')}.hpp>" for name in order]
    text = ["// Written by toolchain/lcm_message_table.py.", '#include "lcmtypes/message_table.h"', "", *includes, "", "namespace tautline {",
            f"[[nodiscard]] MessageTable {function}();", "namespace {", *tables,
            "const MessageInfo* const all[] = {" + ", ".join(f"&{identifier(name)}_info" for name in order) + "};", "}  // namespace",
            f"MessageTable {function}() {{ return all; }}", "}  // namespace tautline", ""]
    pathlib.Path(out).write_text("\n".join(text), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

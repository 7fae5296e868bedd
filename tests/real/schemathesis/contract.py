"""Prints the contract without the sizes that no case should have.

Cases are made at every limit. Those of large arrays, one in another, would take the memory of this machine
before the service heard of them; that they hold is tested elsewhere.
"""

import json
import sys

LARGEST = 100


def without_large_sizes(value):
    if isinstance(value, list):
        return [without_large_sizes(element) for element in value]
    if isinstance(value, dict):
        return {
            name: without_large_sizes(member)
            for name, member in value.items()
            if not (name == "maxItems" and isinstance(member, int) and member > LARGEST)
        }
    return value


with open(sys.argv[1], encoding="utf-8") as contract:
    json.dump(without_large_sizes(json.load(contract)), sys.stdout)

"""Prints the contract without the limits of large arrays.

Schemathesis makes cases at every limit. Nested arrays of that size would use up the memory of the machine before
the service received them. Other tests check these limits.
"""

import json
import sys

# Largest `maxItems` that stays in the printed contract.
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

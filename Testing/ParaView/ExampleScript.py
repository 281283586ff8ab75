# SPDX-License-Identifier: BSD-3-Clause
"""A script of Documentation/Examples: ExampleScript.py <folder>/<script> [its arguments]."""
import sys

from lacuna_test import run_example

run_example(*sys.argv[1:])

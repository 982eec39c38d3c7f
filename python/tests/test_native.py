# SPDX-License-Identifier: GPL-3.0-or-later
"""The classes of the native module, called as nobody should: errors, and the interpreter lives on."""

import copy
import inspect
import pickle
import subprocess
import sys

import pytest

import tubefoot
from tubefoot import _native

CLASSES = [item for item in vars(_native).values() if inspect.isclass(item)]

# Makes an object of a class in a way, and looks at all that the class has.
SCRIPT = """
import sys
from tubefoot import _native
cls = getattr(_native, sys.argv[1])
base = cls.__mro__[1]

class Heir(cls):
    def __new__(kind):
        return base.__new__(kind)

class PlainHeir(cls):
    pass

ways = [lambda: cls(), lambda: cls.__new__(cls), lambda: base.__new__(cls), lambda: object.__new__(cls), lambda: Heir(),
        lambda: PlainHeir(), lambda: PlainHeir.__new__(PlainHeir), lambda: cls.__new__(PlainHeir)]
for number, way in enumerate(ways):
    try:
        made = way()
    except TypeError:
        continue
    print("made", number)
    for member in dir(made):
        getattr(made, member)
"""

# Calls all methods and properties of a class for objects that are none of it.
STRANGERS = """
import sys
from tubefoot import _native
cls = getattr(_native, sys.argv[1])
for name, member in vars(cls).items():
    if name.startswith("__"):
        continue
    call = member.fget if isinstance(member, property) else member
    for stranger in (None, 3, cls, object()):
        for others in range(9):
            try:
                call(stranger, *[None] * others)
            except (TypeError, RuntimeError):
                continue
            print("called", name, stranger, others)
"""


def said_by_python(script, *arguments):
    done = subprocess.run([sys.executable, "-c", script, *arguments], capture_output=True, text=True)
    assert done.returncode == 0, (done.returncode, done.stderr)
    return done.stdout


def test_there_are_classes():
    assert {"Scene", "Transmission", "History", "Result", "Picture", "Coverage", "Footprints", "Signals"} <= {
        c.__name__ for c in CLASSES}


@pytest.mark.parametrize("name", [c.__name__ for c in CLASSES])
def test_no_object_is_made_without_anything_in_it(name):
    assert said_by_python(SCRIPT, name) == ""


@pytest.mark.parametrize("name", [c.__name__ for c in CLASSES])
def test_methods_of_a_class_take_no_strangers(name):
    assert said_by_python(STRANGERS, name) == ""


def test_functions_take_nothing_for_none():
    with pytest.raises(TypeError):
        _native.compare(None, None, None, 1, False)
    with pytest.raises(TypeError):
        _native.chart(dict(scenes=[None], builtin=["tube"], own=[], output="", pings="0", first_pings=None, repeats=1, seconds=1.0), None)


def test_an_object_is_not_copied_and_keeps_its_class(scene):
    native = scene._native
    for way in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError):
            way(native)
    with pytest.raises(TypeError):
        native.__class__ = _native.Signals
    assert native.sensors == ["camera", "side"]


def test_a_class_says_who_makes_its_objects():
    with pytest.raises(TypeError, match="_native.Scene: only functions of tubefoot create objects of this class"):
        _native.Scene.__new__(_native.Scene)
    with pytest.raises(TypeError, match="_native.Scene: only functions of tubefoot create objects of this class"):
        _native.Scene()
    assert tubefoot.Scene.__new__(tubefoot.Scene).__class__ is tubefoot.Scene  # a class of Python's own

# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the study of gradients (make gradients) with few rays, and checks its closed form and the stored certified answers."""

import importlib.util
import json
import sys

import numpy as np
import pytest

from conftest import SOURCES


def module_of(name):
    spec = importlib.util.spec_from_file_location(name, SOURCES / f"validation/gradients/{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def study():
    return module_of("study")


def test_closed_form_is_that_of_the_wall(study):
    energy, by, without = study.closed_form()
    assert energy == pytest.approx(9.091844360675e-9, rel=1e-12)
    assert by["height of the wall"] == pytest.approx(-5.031615580812e-8, rel=1e-12)
    assert by["distance of the wall"] == pytest.approx(-3.144759738007e-8, rel=1e-12)
    assert by["height of the sonar"] == pytest.approx(-1.931701426985e-9, rel=1e-12)
    assert list(without.values()) == pytest.approx([6.06e-9, 1.23e-9], rel=3e-3)


def test_page_compares_all_estimates(study, tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["study.py", str(tmp_path / "page.md"), str(tmp_path), "--quick"])
    study.main()
    exact, _ = study.exact()
    for name, value in study.closed_form()[1].items():
        if name in exact:
            assert exact[name] == pytest.approx(value, rel=1e-3)
    page = (tmp_path / "page.md").read_text()
    assert page.count("| height of the sonar |") == page.count("| distance of the wall |") == 2
    assert (tmp_path / "gradients-rays.svg").read_text().startswith("<svg")


def test_stored_answers_agree_with_certified_derivatives():
    answers = module_of("answers")
    stored = json.loads((SOURCES / "validation/gradients/answers.json").read_text())
    assert set(stored) == set(answers.SCENES)
    for name, parameters in stored.items():
        today = answers.answers(name)
        assert set(parameters) == set(today)
        for key, answer in parameters.items():
            value, bound = np.array(answer["value"]), np.array(answer["bound"])
            largest = np.abs(value).max()
            assert value.shape == (4, 8) and largest > 0 and 0 < bound.max() < 1e-13 * largest
            assert (np.abs(value - today[key]["value"]) <= bound + today[key]["bound"]).all(), (name, key)
            # an answer that is moved by twice its width does not agree
            assert (np.abs(value + 2 * (bound + today[key]["bound"]) - today[key]["value"]) >= bound).all()

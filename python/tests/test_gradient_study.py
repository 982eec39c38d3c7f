# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the study of gradients (make gradients) with few rays, and checks its closed form."""

import importlib.util
import sys

import pytest

from conftest import SOURCES


@pytest.fixture(scope="module")
def study():
    spec = importlib.util.spec_from_file_location("study", SOURCES / "validation/gradients/study.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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

#!/usr/bin/env python3
"""Each lint must see what it is for, and must leave the right thing alone."""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import explained_checks
import file_length
import include_walls
import link_lists
import markdown_paths
import one_definition
import process_state
import tests_run


FOLDER = tempfile.TemporaryDirectory()


class Tree:
    def __init__(self):
        self.root = Path(tempfile.mkdtemp(dir=FOLDER.name))

    def put(self, name, content):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
        return self


class IncludeWalls(unittest.TestCase):
    def refused(self, name, line):
        return include_walls.check(Tree().put(name, line + "\n").root)

    def test_truth_must_not_see_belief(self):
        found = self.refused("rigs/emulated/plant.cpp", '#include "hil/model/effect.h"')
        self.assertEqual(len(found), 1)
        self.assertIn("truth must not see belief", found[0])
        self.assertIn("plant.cpp:1", found[0])

    def test_belief_must_not_see_truth(self):
        self.assertTrue(self.refused("hil/diagnose/fit.cpp", '#include "rigs/emulated/plant.h"'))
        self.assertTrue(self.refused("hil/model/effects/creep.cpp", '#include "rigs/emulated/plant.h"'))

    def test_twin_may_use_the_transport_but_no_codec(self):
        self.assertFalse(self.refused("rigs/emulated/twin.cpp", '#include "adapters/transport/serial.h"'))
        self.assertTrue(self.refused("rigs/emulated/twin.cpp", '#include "adapters/ati_codec.h"'))

    def test_firmware_includes_nothing_of_the_harness(self):
        self.assertTrue(self.refused("rigs/firmware/link.c", '#include "hil/base/digest.h"'))
        self.assertTrue(self.refused("rigs/firmware/link.c", '#include "../../hil/base/digest.h"'))
        self.assertFalse(self.refused("rigs/firmware/link.c", '#include "link_codec.h"'))

    def test_libraries_never_include_the_skins(self):
        self.assertTrue(self.refused("hil/app/gate/gate.cpp", '#include "hil/cli/command.h"'))
        self.assertTrue(self.refused("hil/gate/runner.cpp", '#include "hil/report/figure.h"'))

    def test_a_room_of_app_sees_only_what_stands_before_it(self):
        self.assertFalse(self.refused("hil/app/stored/check.cpp", '#include "hil/app/gate/bundle.h"'))
        self.assertTrue(self.refused("hil/app/gate/bundle.cpp", '#include "hil/app/stored/check.h"'))
        self.assertTrue(self.refused("hil/app/model/fit.cpp", '#include "hil/app/gate/gate.h"'))
        self.assertFalse(self.refused("hil/app/help/explain.cpp", "#include <nlohmann/json.hpp>"))

    def test_what_stands_in_no_room_of_app_is_refused(self):
        self.assertTrue(self.refused("hil/app/gate.cpp", "#include <string>"))
        self.assertTrue(self.refused("hil/app/new_room/gate.cpp", "#include <string>"))

    def test_a_folder_names_only_folders_above_it(self):
        walls = list(include_walls.WALLS.items())
        for at, (own, allowed) in enumerate(walls):
            above = [folder for folder, _ in walls[:at]]
            for folder in allowed or []:
                self.assertTrue(folder == include_walls.EVERY or include_walls.within(folder, above), f"{own}: {folder}")

    def test_third_party_headers_stay_in_their_folder_and_out_of_headers(self):
        self.assertTrue(self.refused("hil/base/text.cpp", "#include <toml++/toml.h>"))
        self.assertTrue(self.refused("hil/gate/plan.h", "#include <toml++/toml.h>"))
        self.assertFalse(self.refused("hil/gate/plan.cpp", "#include <toml++/toml.h>"))

    def test_the_allowed_direction_is_left_alone(self):
        for name, header in [("hil/gate/runner.cpp", "hil/rig/safety_gate.h"), ("hil/app/gate/x.cpp", "rigs/emulated/plant.h"),
                             ("stimuli/sine.cpp", "hil/interface/stimulus.h"), ("hil/gate/a.cpp", "hil/base/text.h")]:
            self.assertEqual(self.refused(name, f'#include "{header}"'), [], name)


class LinkLists(unittest.TestCase):
    def check(self, deps):
        tree = Tree().put("hil/trace/CMakeLists.txt", "forcegate_library(NAME trace SOURCES a.cpp)")
        tree.put("hil/model/CMakeLists.txt", "forcegate_library(NAME model SOURCES a.cpp DEPS forcegate::trace)")
        tree.put("hil/report/CMakeLists.txt", f"forcegate_plugins(NAME report DEPS {deps})").put("hil/report/a.h", '#include "hil/trace/a.h"')
        return link_lists.check(tree.root)

    def test_what_is_included_is_linked_at_first_or_second_hand(self):
        self.assertEqual(self.check("forcegate::trace"), [])
        self.assertEqual(self.check("forcegate::model"), [])
        self.assertEqual(self.check("forcegate::app"), [])
        found = self.check("forcegate::base")
        self.assertEqual(len(found), 1)
        self.assertIn("hil/report/a.h:1", found[0])


class TestsRun(unittest.TestCase):
    def test_a_disabled_test_is_refused(self):
        tree = Tree().put("tests/unit/a/CMakeLists.txt", "").put("tests/unit/a/a_test.cpp", "TEST(A, DISABLED_b) {}\n")
        self.assertEqual(len(tests_run.check(tree.root)), 1)

    def test_two_styles_of_names_in_a_file_are_refused(self):
        tree = Tree().put("tests/unit/a/CMakeLists.txt", "").put("tests/unit/a/a_test.cpp", "TEST(A, b_is_c) {}\nTEST(A, DIsE) {}\n")
        self.assertEqual(len(tests_run.check(tree.root)), 1)
        tree.put("tests/unit/a/a_test.cpp", "TEST(A, b_is_c) {}\nTEST_F(A, d_is_e) {}\n")
        self.assertEqual(tests_run.check(tree.root), [])

    def test_a_hidden_scenario_is_refused(self):
        tree = Tree().put("tests/scenarios/CMakeLists.txt", "")
        tree.put("tests/scenarios/a.cpp", 'TEST_CASE("x", "[.slow]") {}\n')
        self.assertEqual(len(tests_run.check(tree.root)), 1)

    def test_a_skip_must_say_what_it_needs(self):
        tree = Tree().put("tests/unit/a/CMakeLists.txt", "")
        tree.put("tests/unit/a/a_test.cpp", 'GTEST_SKIP() << "needs a display";\n')
        self.assertEqual(tests_run.check(tree.root), [])
        tree.put("tests/unit/a/a_test.cpp", "GTEST_SKIP();\n")
        self.assertEqual(len(tests_run.check(tree.root)), 1)

    def test_a_source_that_nothing_builds_is_refused(self):
        tree = Tree().put("tests/unit/a/a_test.cpp", "TEST(A, b) {}\n")
        self.assertEqual(len(tests_run.check(tree.root)), 1)
        tree.put("tests/unit/a/CMakeLists.txt", "")
        self.assertEqual(tests_run.check(tree.root), [])
        tree.put("build/compile_commands.json", json.dumps([{"file": "/elsewhere/b_test.cpp"}]))
        self.assertEqual(len(tests_run.check(tree.root)), 1)
        tree.put("build/compile_commands.json", json.dumps([{"file": str(tree.root / "tests/unit/a/a_test.cpp")}]))
        self.assertEqual(tests_run.check(tree.root), [])


class MarkdownPaths(unittest.TestCase):
    def check(self, line):
        tree = Tree().put("hil/base/text.h", "").put("docs/paper.md", "# x\n").put("docs/page.md", line + "\n")
        return markdown_paths.check(tree.root)

    def test_a_missing_path_is_found_in_spans_and_links(self):
        self.assertEqual(len(self.check("see `hil/base/gone.h`")), 1)
        self.assertEqual(len(self.check("see [it](gone.md)")), 1)

    def test_a_link_within_the_page_meets_a_heading(self):
        self.assertEqual(self.check("[it](#a-thing-of-8-)\n## A `thing` of 8 %"), [])
        self.assertEqual(len(self.check("[it](#gone)")), 1)

    def test_every_decision_is_in_the_index(self):
        room = "# Decisions: gate\n## One\n"
        tree = Tree().put("docs/decisions.md", "# Decisions\n- [One](decisions/gate.md#one)\n").put("docs/decisions/gate.md", room)
        self.assertEqual(markdown_paths.check(tree.root), [])
        self.assertEqual(len(markdown_paths.check(tree.put("docs/decisions/gate.md", room + "## Two\n").root)), 1)

    def test_a_link_to_another_page_meets_a_heading(self):
        tree = Tree().put("docs/paper.md", "# Paper\n## A thing\n").put("docs/page.md", "[it](paper.md#a-thing)\n")
        self.assertEqual(markdown_paths.check(tree.root), [])
        self.assertEqual(len(markdown_paths.check(tree.put("docs/page.md", "[it](paper.md#gone)\n").root)), 1)

    def test_existing_paths_globs_addresses_and_made_files_are_left_alone(self):
        for line in ["`hil/base/text.h`", "[it](paper.md#x)", "`hil/*/x.h`", "[it](https://example.org/a)", "`build/forcegate`",
                     "`a/b`", "`hil/base/`"]:
            self.assertEqual(self.check(line), [], line)


class FileLength(unittest.TestCase):
    def test_400_lines_are_too_many_and_399_are_not(self):
        tree = Tree().put("hil/a.cpp", "x\n" * 400).put("hil/b.cpp", "x\n" * 399)
        found = file_length.check(tree.root)
        self.assertEqual(len(found), 1)
        self.assertTrue(found[0].startswith("hil/a.cpp:"))


class ExplainedChecks(unittest.TestCase):
    def found(self, name, line):
        return explained_checks.check(Tree().put(explained_checks.EXPLAINED, '{"lag", "check", "Distance in time.", kOwn},\n').put(name, "\n" + line + "\n").root)

    def test_a_check_that_nobody_explains_is_refused(self):
        found = self.found("hil/gate/judge_rate.cpp", 'checks.value_check("rate", "Fastest change", 1.0);')
        self.assertEqual(len(found), 1)
        self.assertTrue(found[0].startswith("hil/gate/judge_rate.cpp:2: forcegate explain does not know the check rate"), found)
        for line in ['check(\n"rate", "Fastest change")', 'j.check = {.id = "rate",', 'c.id = rig ? "lag" : "rate";', 'check("rate", case_id, "Fastest change")']:
            self.assertEqual(len(self.found("hil/app/gate/rate.cpp", line)), 1, line)

    def test_known_checks_and_other_words_are_left_alone(self):
        for name, line in [("hil/gate/lag.cpp", 'value_check("lag", "Distance in time", 1.0);'), ("hil/rig/bench.cpp", '{"rate", "Another list"}'),
                           ("hil/app/gate/bundle.cpp", 'one.id = json["id"];'), ("hil/gate/plan.cpp", 'fail(code, "rate", "plan.toml")')]:
            self.assertEqual(self.found(name, line), [], line)


class ProcessState(unittest.TestCase):
    def refused(self, name, line):
        return process_state.check(Tree().put(name, line + "\n").root)

    def test_a_library_is_no_place_for_the_environment_or_the_console(self):
        found = self.refused("hil/diagnose/fit.cpp", '  if (getenv("TRACE")) fprintf(stderr, "%g", gain);')
        self.assertEqual(len(found), 1)
        self.assertIn("fit.cpp:1: getenv", found[0])
        self.assertTrue(self.refused("rigs/emulated/plant.cpp", '  std::cerr << gain;'))
        self.assertTrue(self.refused("golden/compare/tube.cpp", '  std::printf("%g", gain);'))

    def test_the_console_and_ordinary_text_are_left_alone(self):
        self.assertFalse(self.refused("hil/cli/console.cpp", "  std::fputs(text, stderr);"))
        self.assertFalse(self.refused("hil/gate/text.cpp", "  std::snprintf(text, sizeof text, format, gain);"))
        self.assertFalse(self.refused("adapters/child.h", "/// stdout and stderr (both) go to the log"))


class OneDefinition(unittest.TestCase):
    def check(self, **sources):
        tree = Tree()
        for name, source in sources.items():
            tree.put(name.replace("__", "/") + ".h", source)
        return one_definition.check(tree.root)

    def test_two_types_of_one_name_are_refused(self):
        found = self.check(hil__a="namespace forcegate {\nstruct Limit {\n  int a;\n};\n}\n", hil__b="namespace forcegate {\nclass Limit final : public A<int> {\n};\n}\n")
        self.assertEqual(len(found), 1)
        self.assertTrue(found[0].startswith("hil/b.h:2: forcegate::Limit is another type in hil/a.h:2"), found)
        self.assertTrue(self.check(hil__a="namespace forcegate {\nenum class Turn : int { up };\n}\n", hil__b="namespace forcegate {\nunion Turn {};\n}\n"))

    def test_what_the_compiler_keeps_apart_is_left_alone(self):
        one = "namespace forcegate {\nstruct Limit {};\n}\n"
        for other in ["namespace forcegate {\nnamespace {\nstruct Limit {};\n}\n}\n", "namespace forcegate::ati {\nstruct Limit {};\n}\n", "namespace forcegate {\nstruct Limit;\n}\n",
                      "namespace forcegate {\nclass Judge {\n  struct Limit {};\n};\n}\n", "namespace forcegate {\n// struct Limit {\nconst char* const k = \"struct Limit {\";\n}\n",
                      "namespace forcegate {\ntemplate <>\nstruct Limit<int> {};\nstruct Limit named();\n}\n"]:
            self.assertEqual(self.check(hil__a=one, hil__b=other), [], other)

    def test_each_folder_of_tests_is_a_program(self):
        one = "namespace forcegate {\nstruct Bench {};\n}\n"
        self.assertEqual(self.check(tests__unit__a__x=one, tests__unit__b__x=one), [])
        self.assertEqual(len(self.check(tests__unit__a__x=one, tests__unit__a__y=one)), 1)
        self.assertEqual(len(self.check(tests__unit__a__x=one, hil__y=one)), 1)


ROOT = Path(__file__).resolve().parents[2]


class Stages(unittest.TestCase):
    def test_a_folder_that_could_not_be_configured_is_not_taken_for_configured(self):
        with tempfile.TemporaryDirectory() as folder:
            cmake = Path(folder) / "cmake"
            cmake.write_text("#!/bin/sh\ncase \"$*\" in *BAD*) exit 1;; esac\nmkdir -p build && : >build/build.ninja\n")
            cmake.chmod(0o755)
            # as in a stage, whose code is looked at: there bash ignores "set -e"
            script = f'set -e; . {ROOT}/ci/lib/stages.sh; PATH={folder}:$PATH; for o in good BAD BAD good; do if configure build $o; then echo yes; else echo no; fi; done'
            got = subprocess.run(["bash", "-c", script], cwd=folder, capture_output=True, text=True, check=True)
        self.assertEqual(got.stdout.split(), ["yes", "no", "no", "yes"], got.stderr)


class Nightly(unittest.TestCase):
    def code(self, first, second):
        got = subprocess.run(["bash", "-c", f". ci/lib/stages.sh; worse_code {first} {second}"], cwd=ROOT, capture_output=True, text=True, check=True)
        return int(got.stdout)

    def test_neither_gate_hides_what_the_other_found(self):
        self.assertEqual(self.code(0, 0), 0)
        for other in (0, 3, 4, 5, 6):
            self.assertEqual(self.code(1, other), 1)
            self.assertEqual(self.code(other, 1), 1)
        self.assertEqual(self.code(4, 0), 4)
        self.assertEqual(self.code(0, 4), 4)
        self.assertEqual(self.code(4, 3), 3, "no retry gives what is missing")
        self.assertEqual(self.code(3, 4), 3)

    def test_every_gate_of_the_nightly_is_on_the_pages_of_both_servers(self):
        folders = re.findall(r"--output (build/\S+)", (ROOT / "ci/nightly").read_text())
        self.assertEqual(len(folders), 2)
        for folder in folders:
            self.assertIn(folder + "/junit.xml", (ROOT / ".gitlab-ci.yml").read_text())
            self.assertIn(folder + "/summary.md", (ROOT / ".github/workflows/nightly.yml").read_text())


if __name__ == "__main__":
    unittest.main(verbosity=1)

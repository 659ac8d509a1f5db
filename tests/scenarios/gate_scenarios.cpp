#include <catch2/catch.hpp>

#include "tests/scenarios/bench.h"

using forcegate::test::Bench;
using forcegate::test::Outcome;

SCENARIO("a sound bench accepts a good build") {
  GIVEN("a sound bench") {
    const Bench bench;
    WHEN("the reference build is gated") {
      const Outcome outcome = bench.gates("reference.native.so");
      INFO(outcome.text);
      THEN("it is accepted and nobody has to act") {
        CHECK(outcome.exit_code == 0);
        CHECK(outcome.decision == "ACCEPT");
        CHECK(outcome.blame == "none");
      }
    }
  }
}

SCENARIO("a bench whose ATI reads 0.3 N at rest decides nothing and blames the ATI") {
  GIVEN("a bench whose ATI reads 0.3 N too much") {
    Bench bench;
    bench.is_given("reference_offset=0.3");
    WHEN("a good build is gated") {
      const Outcome outcome = bench.gates("reference.native.so");
      INFO(outcome.text);
      THEN("there is no decision and the reference is blamed") {
        CHECK(outcome.exit_code == 4);
        CHECK(outcome.decision == "NO-DECISION");
        CHECK(outcome.blame == "reference");
      }
    }
  }
}

SCENARIO("a bench whose ATI overloads decides nothing even about a bad build") {
  GIVEN("a bench whose ATI overloads at 2 N") {
    Bench bench;
    bench.is_given("reference_saturated=2.0");
    WHEN("a build without compensation is gated") {
      const Outcome outcome = bench.gates("mutants/compensation_off.native.so");
      INFO(outcome.text);
      THEN("the build is neither accepted nor rejected") {
        CHECK(outcome.exit_code == 4);
        CHECK(outcome.decision == "NO-DECISION");
        CHECK(outcome.blame != "firmware");
      }
    }
  }
}

SCENARIO("a bench whose motor stalls decides nothing") {
  GIVEN("a bench whose motor stops after a minute") {
    Bench bench;
    bench.is_given("motor_stalled=60");
    WHEN("a good build is gated") {
      const Outcome outcome = bench.gates("reference.native.so");
      INFO(outcome.text);
      THEN("there is no decision and the build is not blamed") {
        CHECK(outcome.exit_code == 4);
        CHECK(outcome.decision == "NO-DECISION");
        CHECK(outcome.blame != "firmware");
      }
    }
  }
}

SCENARIO("a frozen ATI is noticed") {
  GIVEN("a bench whose ATI repeats its reading from second 30 on") {
    Bench bench;
    bench.is_given("reference_frozen=30");
    WHEN("a good build is gated") {
      const Outcome outcome = bench.gates("reference.native.so");
      INFO(outcome.text);
      THEN("there is no decision and the reference is blamed") {
        CHECK(outcome.exit_code == 4);
        CHECK(outcome.blame == "reference");
      }
    }
  }
}

SCENARIO("a lost tail of a record is never an accept") {
  GIVEN("a bench whose records end after 100 s") {
    Bench bench;
    bench.is_given("truncated=100");
    WHEN("a good build is gated") {
      const Outcome outcome = bench.gates("reference.native.so");
      INFO(outcome.text);
      THEN("there is no decision") {
        CHECK((outcome.exit_code == 3 || outcome.exit_code == 4));
        CHECK(outcome.decision == "NO-DECISION");
      }
    }
  }
}

SCENARIO("a build without compensation is rejected and the report names the maxima") {
  GIVEN("a sound bench") {
    const Bench bench;
    WHEN("a build whose compensation is off is gated") {
      const Outcome outcome = bench.gates("mutants/compensation_off.native.so");
      INFO(outcome.text);
      THEN("it is rejected because of the maxima") {
        CHECK(outcome.exit_code == 1);
        CHECK(outcome.decision == "REJECT");
        CHECK(outcome.blame == "firmware");
        CHECK(outcome.reason.find("axima") != std::string::npos);
      }
    }
  }
}

SCENARIO("a specimen that was told nothing about rejects a good build and says why") {
  GIVEN("a bench that gives the firmware only the paper's values") {
    Bench bench;
    bench.calibrates_to_level("nominal");
    WHEN("a good build is gated") {
      const Outcome outcome = bench.gates("reference.native.so");
      INFO(outcome.text);
      THEN("it is rejected and the calibration level is named as the cause") {
        CHECK(outcome.exit_code == 1);
        CHECK(outcome.decision == "REJECT");
        CHECK(outcome.blame == "calibration");
        CHECK(outcome.reason.find("calibration") != std::string::npos);
      }
    }
  }
}

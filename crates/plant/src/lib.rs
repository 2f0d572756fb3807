//! A flexible-joint robot in software: friction, spring, RK4, sensors, controller, testbeds.

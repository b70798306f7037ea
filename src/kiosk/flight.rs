//! From the plan into a slow oblique flight, and back.

use super::lived::Lived;

/// How long the view takes to leave the plan, and to come back, ms.
const RISE_MS: u64 = 6000;
const WAKE_MS: u64 = 800;

/// With so little of the flight left the picture lies under the fingers again.
const PLAN: f64 = 0.02;

/// What one look may add to the time, ms: after a halt the camera goes on where it was.
const LONGEST_LOOK_MS: u64 = 200;

/// What the view should do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightWish {
    /// Stay in the plan (the clock stands, a menu is open, hands of the show push).
    Plan,
    /// Fly when nobody has touched for a while.
    WhenUntouched,
    /// Fly now (the show rests).
    Fly,
}

/// How far the view is from the plan.
#[derive(Clone, Debug)]
pub struct Flight {
    after_ms: u64,
    reduced_motion: bool,
    lived: Lived,
    flying: bool,
    /// How far it was when it last turned, and when that was, ms lived.
    from: f64,
    turned_ms: u64,
    amount: f64,
    aloft_ms: u64,
}

impl Flight {
    /// In the plan. It flies when untouched for `after_ms`; with reduced motion never.
    pub fn new(after_ms: u64, reduced_motion: bool) -> Self {
        Self {
            after_ms,
            reduced_motion,
            lived: Lived::new(LONGEST_LOOK_MS),
            flying: false,
            from: 0.0,
            turned_ms: 0,
            amount: 0.0,
            aloft_ms: 0,
        }
    }

    /// Time goes on: to be called once a frame, and after each touch, with the time since somebody was there
    /// ([`super::Kiosk::untouched_ms`]). A touch so turns the view back to the plan at once.
    pub fn tick(&mut self, now_ms: u64, wish: FlightWish, untouched_ms: u64) {
        let before_ms = self.lived.total();
        let now_ms = self.lived.at(now_ms);
        let fly = match wish {
            FlightWish::Plan => false,
            FlightWish::WhenUntouched => untouched_ms >= self.after_ms,
            FlightWish::Fly => true,
        } && !self.reduced_motion;
        if fly != self.flying {
            self.flying = fly;
            self.from = self.amount;
            self.turned_ms = now_ms;
        }
        let (goal, time_ms) = if fly { (1.0, RISE_MS) } else { (0.0, WAKE_MS) };
        let part = (now_ms - self.turned_ms) as f64 / time_ms as f64;
        self.amount = self.from + (goal - self.from) * ease(part);
        if self.amount > 0.0 {
            self.aloft_ms += now_ms - before_ms;
        } else {
            self.aloft_ms = 0;
        }
    }

    /// 0 in the plan, 1 in full flight.
    pub fn amount(&self) -> f64 {
        self.amount
    }

    /// True while the picture does not lie under the fingers: contacts that land now wake it and sculpt nothing.
    pub fn in_flight(&self) -> bool {
        self.amount > PLAN
    }

    /// True while it comes back to the plan.
    pub fn waking(&self) -> bool {
        !self.flying && self.amount > 0.0
    }

    /// Time since it left the plan, s: where the camera is on its slow way round.
    pub fn aloft_s(&self) -> f64 {
        self.aloft_ms as f64 / 1000.0
    }
}

/// 0 to 1 without a jerk at either end (6x⁵ − 15x⁴ + 10x³).
fn ease(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * (x * 6.0 - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AFTER_MS: u64 = 25_000;

    /// Looks every 16 ms.
    fn run(flight: &mut Flight, now_ms: &mut u64, ms: u64, wish: FlightWish, touched_ms: u64) {
        let end = *now_ms + ms;
        while *now_ms < end {
            *now_ms += 16;
            let before = flight.amount();
            flight.tick(*now_ms, wish, *now_ms - touched_ms);
            assert!((flight.amount() - before).abs() < 0.05, "it jumps");
        }
    }

    #[test]
    fn untouched_it_flies_and_a_touch_brings_it_back_within_a_second() {
        let (mut flight, mut now) = (Flight::new(AFTER_MS, false), 0);
        run(
            &mut flight,
            &mut now,
            AFTER_MS - 100,
            FlightWish::WhenUntouched,
            0,
        );
        assert_eq!(flight.amount(), 0.0);
        run(&mut flight, &mut now, 3000, FlightWish::WhenUntouched, 0);
        assert!(flight.in_flight() && !flight.waking());
        run(&mut flight, &mut now, 4000, FlightWish::WhenUntouched, 0);
        assert_eq!(flight.amount(), 1.0);
        assert!(flight.aloft_s() > 6.0);
        let touched = now;
        run(&mut flight, &mut now, 400, FlightWish::WhenUntouched, touched);
        assert!(flight.waking() && flight.in_flight());
        run(&mut flight, &mut now, 450, FlightWish::WhenUntouched, touched);
        assert_eq!(flight.amount(), 0.0);
        assert!(!flight.waking() && !flight.in_flight());
        assert_eq!(flight.aloft_s(), 0.0);
    }

    #[test]
    fn it_turns_wherever_it_is_without_a_jump() {
        let (mut flight, mut now) = (Flight::new(AFTER_MS, false), 0);
        for _ in 0..20 {
            run(&mut flight, &mut now, 2500, FlightWish::Fly, 0);
            run(&mut flight, &mut now, 300, FlightWish::Plan, 0);
        }
        assert!((0.0..=1.0).contains(&flight.amount()));
    }

    #[test]
    fn wishes_and_reduced_motion_are_respected() {
        let (mut flight, mut now) = (Flight::new(AFTER_MS, false), 0);
        run(&mut flight, &mut now, 60_000, FlightWish::Plan, 0);
        assert_eq!(flight.amount(), 0.0);
        let mut still = Flight::new(AFTER_MS, true);
        run(&mut still, &mut now, 60_000, FlightWish::Fly, 0);
        assert_eq!(still.amount(), 0.0);
    }

    #[test]
    fn a_clock_that_jumps_moves_the_camera_by_a_few_frames_at_most() {
        let (mut flight, mut now) = (Flight::new(AFTER_MS, false), 0);
        run(&mut flight, &mut now, 3000, FlightWish::Fly, 0);
        let before = flight.amount();
        flight.tick(now + 3_600_000, FlightWish::Fly, 0);
        flight.tick(5, FlightWish::Fly, 0);
        assert!((flight.amount() - before).abs() < 0.1);
    }
}

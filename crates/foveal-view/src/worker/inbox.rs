//! What the window asks the drawing thread for: the newest request of each kind.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::Request;
use crate::capture::Job;
use crate::pick::Ray;

/// What is to be done next.
pub(super) enum Order {
    Quit,
    Load(String),
    Draw(Box<Request>),
    /// Which object a ray meets.
    Pick(Ray),
    Capture(Box<Job>),
    /// Gives a capture up.
    CancelCapture,
    LoseDevice,
    Nothing,
}

#[derive(Default)]
struct Orders {
    quit: bool,
    load: Option<String>,
    draw: Option<Request>,
    pick: Option<Ray>,
    capture: Option<Job>,
    cancel_capture: bool,
    lose_device: bool,
}

#[derive(Default)]
pub(super) struct Inbox {
    orders: Mutex<Orders>,
    changed: Condvar,
}

impl Inbox {
    fn orders(&self) -> MutexGuard<'_, Orders> {
        // Whoever panicked left whole orders behind.
        self.orders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn quit(&self) {
        self.orders().quit = true;
        self.changed.notify_one();
    }

    /// What was asked of the scene before is asked no more.
    pub(super) fn load(&self, scene: String) {
        let mut orders = self.orders();
        orders.load = Some(scene);
        orders.draw = None;
        orders.pick = None;
        self.changed.notify_one();
    }

    pub(super) fn draw(&self, request: Request) {
        self.orders().draw = Some(request);
        self.changed.notify_one();
    }

    pub(super) fn pick(&self, ray: Ray) {
        self.orders().pick = Some(ray);
        self.changed.notify_one();
    }

    pub(super) fn capture(&self, job: Job) {
        self.orders().capture = Some(job);
        self.changed.notify_one();
    }

    pub(super) fn cancel_capture(&self) {
        let mut orders = self.orders();
        orders.capture = None;
        orders.cancel_capture = true;
        self.changed.notify_one();
    }

    pub(super) fn lose_device(&self) {
        self.orders().lose_device = true;
        self.changed.notify_one();
    }

    /// The next order; waits for one if `idle`.
    pub(super) fn next(&self, idle: bool) -> Order {
        let mut orders = self.orders();
        loop {
            if orders.quit {
                return Order::Quit;
            }
            if std::mem::take(&mut orders.lose_device) {
                return Order::LoseDevice;
            }
            if std::mem::take(&mut orders.cancel_capture) {
                return Order::CancelCapture;
            }
            if let Some(scene) = orders.load.take() {
                return Order::Load(scene);
            }
            if let Some(ray) = orders.pick.take() {
                return Order::Pick(ray);
            }
            if let Some(job) = orders.capture.take() {
                return Order::Capture(Box::new(job));
            }
            if let Some(request) = orders.draw.take() {
                return Order::Draw(Box::new(request));
            }
            if !idle {
                return Order::Nothing;
            }
            orders = self
                .changed
                .wait(orders)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

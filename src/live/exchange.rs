//! Three values that circulate between a writer and a reader: the newest wins, and nobody waits.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

/// The value on its way, and whether the reader has not seen it.
#[derive(Debug)]
struct Waiting<T> {
    value: Box<T>,
    fresh: bool,
}

/// The writer's end: it always has a value of its own to fill.
#[derive(Debug)]
pub(super) struct Writer<T> {
    own: Box<T>,
    waiting: Arc<Mutex<Waiting<T>>>,
}

/// The reader's end: it keeps the value it has for as long as it likes.
#[derive(Debug)]
pub(super) struct Reader<T> {
    own: Box<T>,
    waiting: Arc<Mutex<Waiting<T>>>,
}

/// Both ends. The reader starts with the first value.
pub(super) fn exchange<T>([read, waiting, written]: [T; 3]) -> (Writer<T>, Reader<T>) {
    let waiting = Arc::new(Mutex::new(Waiting {
        value: Box::new(waiting),
        fresh: false,
    }));
    let writer = Writer {
        own: Box::new(written),
        waiting: Arc::clone(&waiting),
    };
    let reader = Reader {
        own: Box::new(read),
        waiting,
    };
    (writer, reader)
}

impl<T> Writer<T> {
    /// The value to fill next; it holds what was written some publications ago.
    pub(super) fn back(&mut self) -> &mut T {
        &mut self.own
    }

    /// Hands it over; if the one before was not seen, it is not going to be.
    pub(super) fn publish(&mut self) {
        // Only pointers are swapped under the lock, which cannot panic.
        let mut waiting: MutexGuard<'_, _> = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::swap(&mut waiting.value, &mut self.own);
        waiting.fresh = true;
    }
}

impl<T> Reader<T> {
    /// The value that was taken last, again.
    pub(super) fn current(&self) -> &T {
        &self.own
    }

    /// The newest value that was handed over, or the one from before while one is being handed over.
    pub(super) fn newest(&mut self) -> &T {
        let waiting = match self.waiting.try_lock() {
            Ok(waiting) => Some(waiting),
            Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        };
        if let Some(mut waiting) = waiting
            && std::mem::take(&mut waiting.fresh)
        {
            std::mem::swap(&mut waiting.value, &mut self.own);
        }
        &self.own
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_wins_and_three_values_circulate() {
        let (mut writer, mut reader) = exchange([0, 1, 2]);
        assert_eq!(*reader.newest(), 0);
        for value in 10..15 {
            *writer.back() = value;
            writer.publish();
        }
        assert_eq!(*reader.newest(), 14);
        assert_eq!(*reader.newest(), 14, "nothing new");
        *writer.back() = 15;
        writer.publish();
        assert_eq!(*reader.newest(), 15);
    }

    #[test]
    fn a_reader_keeps_its_value_whole_while_others_are_written() {
        const ROUNDS: u64 = 20_000;
        let (mut writer, mut reader) = exchange([(); 3].map(|()| vec![0_u64; 512]));
        let writing = std::thread::spawn(move || {
            for round in 1..=ROUNDS {
                for value in writer.back().iter_mut() {
                    *value = round;
                }
                writer.publish();
            }
        });
        let mut last = 0;
        while last < ROUNDS {
            let values = reader.newest();
            let first = values[0];
            assert!(values.iter().all(|&value| value == first), "torn at {first}");
            assert!(first >= last, "{first} after {last}");
            last = first;
        }
        writing.join().unwrap();
    }

    #[test]
    fn a_reader_does_not_wait_for_a_writer() {
        let (writer, mut reader) = exchange([0, 1, 2]);
        let held = writer.waiting.lock().unwrap();
        assert_eq!(*reader.newest(), 0, "what it had");
        drop(held);
    }
}

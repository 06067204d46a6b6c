//! A client of the live channel, as the room sees it: what each of its messages does.

use std::sync::Arc;

use orogeny_engine::session::Travel;
use orogeny_engine::{BrushOperation, Operation, PointerSample};

use crate::http::operations::{label, read_operations};
use crate::hub::{Asker, Client, ClientId, Task};
use crate::message::{self, Message};
use crate::outbox::Latest;
use crate::reply::Refusal;
use crate::room::Room;
use crate::service::Shared;
use crate::subscription::{Subscription, Wish};

/// A client that is there; it leaves when this is dropped.
pub(crate) struct Connection {
    pub(crate) shared: Arc<Shared>,
    pub(crate) room: Arc<Room>,
    pub(crate) id: ClientId,
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.room.hub().leave(self.id);
    }
}

impl Connection {
    /// Does what a message says, or tells the client why not.
    pub(crate) fn hear(&self, text: &str) {
        let heard =
            Message::read(text).map_err(|refusal| (None, refusal)).and_then(|message| self.take(message));
        if let Err((id, refusal)) = heard {
            self.refuse(id, &refusal);
        }
    }

    /// Tells the client that something was not done.
    pub(crate) fn refuse(&self, id: Option<u64>, refusal: &Refusal) {
        self.shared.metrics.refusals.get_or_create(&vec![("code", refusal.code)]).inc();
        self.with_client(|_, client| client.outbox.text(message::error(id, refusal)));
    }

    fn take(&self, message: Message) -> Result<(), (Option<u64>, Refusal)> {
        match message {
            Message::BeginStroke { id, operation } => {
                self.begin_stroke(id, operation).map_err(|err| (Some(id), err))
            }
            Message::Points { id, points } => self.push_points(id, points).map_err(|err| (Some(id), err)),
            Message::EndStroke { id } => {
                self.with_task(id, |client, task| {
                    client.participant.lift(task.ticket);
                    task.is_open = false;
                });
                Ok(())
            }
            Message::CancelStroke { id } => {
                self.with_task(id, |client, task| client.participant.cancel(task.ticket));
                Ok(())
            }
            Message::Apply { id, operations } => self.apply(id, operations).map_err(|err| (Some(id), err)),
            Message::Undo { id, anyone } => {
                let travel = if anyone { Travel::Undo(1) } else { Travel::UndoOwn };
                self.travel(id, "undo", travel).map_err(|err| (Some(id), err))
            }
            Message::Redo { id, anyone } => {
                let travel = if anyone { Travel::Redo(1) } else { Travel::RedoOwn };
                self.travel(id, "redo", travel).map_err(|err| (Some(id), err))
            }
            Message::Subscribe { id, region, level, format, window } => {
                let window = window.min(self.shared.limits.window);
                let wish = Wish { region_m: region, level, format, window };
                self.subscribe(wish).map_err(|err| (id, err))
            }
            Message::Unsubscribe {} => {
                self.with_client(|_, client| client.subscription = None);
                Ok(())
            }
            Message::Ack { frames } => {
                self.with_client(|_, client| {
                    client.num_acknowledged = client.num_acknowledged.max(frames.min(client.num_frames));
                });
                self.room.look();
                Ok(())
            }
            Message::Cursor { x, z, radius } => {
                self.tell_cursor([x, z], radius);
                Ok(())
            }
        }
    }

    fn begin_stroke(&self, id: u64, operation: serde_json::Value) -> Result<(), Refusal> {
        let not_understood = |message: String| Refusal::new("operation", message);
        if operation.get("op").is_none_or(|op| op != "stroke") {
            return Err(not_understood("the operation of a stroke is a `stroke`".to_owned()));
        }
        let mut operation = operation;
        let none = || serde_json::Value::Array(Vec::new());
        let points = operation.as_object_mut().and_then(|fields| fields.insert("points".to_owned(), none()));
        let early: Vec<PointerSample> = serde_json::from_value(points.unwrap_or_else(none))
            .map_err(|err| not_understood(err.to_string()))?;
        let operations = read_operations(&self.shared, vec![operation])?;
        let what = label(&operations);
        let Some(Operation::Brush(stroke @ BrushOperation::Stroke { .. })) = operations.into_iter().next()
        else {
            return Err(not_understood("the operation of a stroke is a `stroke`".to_owned()));
        };
        let num_points = early.len();
        if num_points > self.shared.limits.points_per_client {
            return Err(too_many_points(self.shared.limits.points_per_client));
        }
        self.give(id, what, Some(num_points), move |client| {
            let ticket = client.participant.begin_stroke(stroke);
            if !early.is_empty() {
                client.participant.push_points(ticket, early);
            }
            ticket
        })
    }

    fn push_points(&self, id: u64, points: Vec<PointerSample>) -> Result<(), Refusal> {
        let limit = self.shared.limits.points_per_client;
        let pushed = self.with_client(|_, client| {
            // Points of a stroke that has ended, as by others' waiting, are late and harm nothing.
            let task = client.tasks.get_mut(&id).filter(|task| task.is_open)?;
            task.num_points += points.len();
            let ticket = task.ticket;
            if client.tasks.values().map(|task| task.num_points).sum::<usize>() > limit {
                client.participant.cancel(ticket);
                return Some(Err(too_many_points(limit)));
            }
            client.participant.push_points(ticket, points);
            Some(Ok(()))
        });
        pushed.flatten().unwrap_or(Ok(()))
    }

    fn apply(&self, id: u64, operations: Vec<serde_json::Value>) -> Result<(), Refusal> {
        let operations = read_operations(&self.shared, operations)?;
        self.give(id, label(&operations), None, |client| client.participant.apply(operations))
    }

    fn travel(&self, id: u64, what: &str, travel: Travel) -> Result<(), Refusal> {
        self.give(id, what.to_owned(), None, |client| client.participant.travel(travel))
    }

    /// Asks the session for something, under the client's number.
    fn give(
        &self,
        id: u64,
        what: String,
        num_points: Option<usize>,
        give: impl FnOnce(&Client) -> orogeny_engine::session::Ticket,
    ) -> Result<(), Refusal> {
        let mut hub = self.room.hub();
        self.room.check_room(&hub)?;
        let Some(client) = hub.clients.get_mut(&self.id) else { return Ok(()) };
        let limit = self.shared.limits.tasks_per_client;
        if client.tasks.len() >= limit {
            let message =
                format!("{limit} things that you asked for are not done yet: wait for some of them");
            return Err(Refusal::new("too_many_tasks", message).with_limit(limit as u64));
        }
        if client.tasks.contains_key(&id) {
            let message = format!("what you asked for as {id} is not done yet: take another number");
            return Err(Refusal::new("id_in_use", message));
        }
        let ticket = give(client);
        client
            .tasks
            .insert(id, Task { ticket, num_points: num_points.unwrap_or(0), is_open: num_points.is_some() });
        let author = Arc::clone(&client.author);
        hub.note(ticket, Asker::Client { client: self.id, id }, author, what);
        Ok(())
    }

    fn subscribe(&self, wish: Wish) -> Result<(), Refusal> {
        {
            let mut hub = self.room.hub();
            let Some(status) = hub.status.clone() else { return Ok(()) };
            let mut subscription =
                Subscription::new(wish, &status, self.shared.limits.pages_per_subscription)?;
            if let Some(client) = hub.clients.get_mut(&self.id) {
                if let Some(before) = client.subscription.take() {
                    subscription.take_over(before);
                }
                client.subscription = Some(subscription);
            }
        }
        self.room.look();
        Ok(())
    }

    fn tell_cursor(&self, [x, z]: [f64; 2], radius: f64) {
        let text = message::cursor(self.id, [x, z], radius);
        let hub = self.room.hub();
        for (_, other) in hub.clients.iter().filter(|(id, _)| **id != self.id) {
            other.outbox.latest(Latest::Cursor(self.id), text.clone());
        }
    }

    fn with_client<T>(&self, work: impl FnOnce(&ClientId, &mut Client) -> T) -> Option<T> {
        self.room.hub().clients.get_mut(&self.id).map(|client| work(&self.id, client))
    }

    fn with_task<T>(&self, id: u64, work: impl FnOnce(&Client, &mut Task) -> T) -> Option<T> {
        self.with_client(|_, client| {
            let mut task = client.tasks.get(&id).copied()?;
            let result = work(client, &mut task);
            client.tasks.insert(id, task);
            Some(result)
        })
        .flatten()
    }
}

fn too_many_points(limit: usize) -> Refusal {
    let message = format!(
        "your strokes that are not done have more than {limit} points, and the last one was taken back: end them earlier"
    );
    Refusal::new("too_many_points", message).with_limit(limit as u64)
}

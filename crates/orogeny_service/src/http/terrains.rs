//! Which terrains there are, and what they are.

use axum::Json;
use axum::extract::State;
use serde_json::{Value, json};

use super::{Named, Service};
use crate::reply::Failure;
use crate::room::Room;

pub(super) async fn list(State(shared): Service) -> Result<Json<Value>, Failure> {
    let mut terrains = Vec::with_capacity(shared.rooms.len());
    for room in shared.rooms.values() {
        terrains.push(summary(room).await?);
    }
    Ok(Json(json!({ "terrains": terrains })))
}

async fn summary(room: &Room) -> Result<Value, Failure> {
    let status = room.status().await?;
    let hub = room.hub();
    Ok(json!({
        "name": room.name,
        "width": status.grid.width(),
        "depth": status.grid.depth(),
        "spacing": status.grid.spacing_m(),
        "lowest": status.root.1.bounds.min_m,
        "highest": status.root.1.bounds.max_m,
        "revision": hub.revision,
        "clients": hub.clients.len(),
    }))
}

pub(super) async fn one(Named(room): Named) -> Result<Json<Value>, Failure> {
    let mut terrain = summary(&room).await?;
    let status = room.status().await?;
    let clients: Vec<_> = {
        let hub = room.hub();
        let clients = hub.clients.iter();
        clients.map(|(id, client)| json!({ "client": id, "author": &*client.author })).collect()
    };
    if let Some(fields) = terrain.as_object_mut() {
        let [can_undo, can_redo] = status.can_undo_redo();
        fields.insert("page_size".to_owned(), status.layout.size().into());
        fields.insert("levels".to_owned(), status.root.0.level.into());
        fields.insert("layers".to_owned(), json!(status.descriptions));
        fields.insert("head".to_owned(), status.current_entry().0.into());
        fields.insert("can_undo".to_owned(), can_undo.into());
        fields.insert("can_redo".to_owned(), can_redo.into());
        fields.insert("memory".to_owned(), json!(status.memory));
        fields.insert("file_size_in_bytes".to_owned(), status.file_size_in_bytes.into());
        fields.insert("clients".to_owned(), clients.into());
    }
    Ok(Json(terrain))
}

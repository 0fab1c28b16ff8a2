//! The socket of one page: questions in, answers and events out.

use std::sync::Arc;

use axum::extract::ws::{Message as Frame, WebSocket, WebSocketUpgrade};
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use futures_util::{SinkExt, StreamExt};
use serde::Deserialize;
use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore, mpsc};

use super::Shared;
use crate::engine::Engine;
use crate::protocol::{Event, Message, Question};

/// Longest question (bytes): the text of a task with hundreds of objects has some tens of thousands.
const LONGEST: usize = 4 << 20;
/// Questions of a page that may wait: each may be as long as the longest.
const MOST_WAITING: usize = 64;
/// Questions of a page that are answered at once.
const AT_ONCE: usize = 4;

#[derive(Deserialize)]
pub struct Ticket {
    token: Option<String>,
}

/// Opens a socket for those who may speak to the engine.
pub async fn accept(State(shared): State<Shared>, Query(ticket): Query<Ticket>, upgrade: WebSocketUpgrade) -> Response {
    if !shared.guard.admits(ticket.token.as_deref()) {
        let missing = "the token is missing or wrong: open the address that the studio printed\n";
        return (StatusCode::UNAUTHORIZED, missing).into_response();
    }
    upgrade.max_message_size(LONGEST).on_upgrade(move |socket| talk(shared.engine, socket))
}

/// Talks until the page is gone.
async fn talk(engine: Arc<Engine>, socket: WebSocket) {
    let (mut to, mut from) = socket.split();
    let bell = Arc::new(Notify::new());
    let ear = engine.hub().listen({
        let bell = Arc::clone(&bell);
        move || bell.notify_one()
    });
    let (reply, mut replies) = mpsc::channel::<Message>(AT_ONCE);
    let (turns, waiting) = (Arc::new(Semaphore::new(AT_ONCE)), Arc::new(Semaphore::new(MOST_WAITING)));
    if to.send(state(&engine)).await.is_err() {
        return;
    }
    loop {
        tokio::select! {
            frame = from.next() => match frame {
                Some(Ok(Frame::Text(text))) => {
                    // A page asks a few questions at a time; what asks without listening is none.
                    let Ok(place) = Arc::clone(&waiting).try_acquire_owned() else { return };
                    answer(&engine, text.to_string(), (&turns, place), reply.clone());
                }
                Some(Ok(Frame::Close(_)) | Err(_)) | None => return,
                Some(Ok(_)) => {}
            },
            Some(message) = replies.recv() => {
                if to.send(frame(&message)).await.is_err() {
                    return;
                }
            }
            () = bell.notified() => {
                while let Some(message) = ear.hear() {
                    if to.send(frame(&message)).await.is_err() {
                        return;
                    }
                }
                if ear.has_lost() && to.send(state(&engine)).await.is_err() {
                    return;
                }
            }
        }
    }
}

/// Answers in a thread that may compute, a few questions of a page at once.
fn answer(
    engine: &Arc<Engine>,
    text: String,
    (turns, place): (&Arc<Semaphore>, OwnedSemaphorePermit),
    reply: mpsc::Sender<Message>,
) {
    let (engine, turns) = (Arc::clone(engine), Arc::clone(turns));
    tokio::spawn(async move {
        let (_place, Ok(_turn)) = (place, turns.acquire_owned().await) else { return };
        // What is no question has no number to answer to.
        let Ok(question) = serde_json::from_str::<Question>(&text) else { return };
        if let Ok(message) = tokio::task::spawn_blocking(move || engine.answer(question)).await {
            // The page may be gone.
            let _ = reply.send(message).await;
        }
    });
}

fn state(engine: &Engine) -> Frame {
    let state: Event = engine.state();
    Frame::Text(serde_json::to_string(&state).unwrap_or_default().into())
}

fn frame(message: &Message) -> Frame {
    match message {
        Message::Text(text) => Frame::Text(text.clone().into()),
        Message::Motion(header, numbers) => Frame::Binary(Message::bytes(header, numbers).into()),
    }
}

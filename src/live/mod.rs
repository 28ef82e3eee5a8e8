//! A web server for `tangency live`; the diagrams of its page follow changes of a scene.
//!
//! The server listens on the loopback interface only, and its address contains a random token. The
//! page contains no knowledge of problems: the server sends descriptions of parameters, settings,
//! columns and possible follow-up runs as JSON ([`Setup`] is the state of a page), and traces the
//! scene after each change with the functions of [`scene`](crate::scene).
//!
//! ```no_run
//! use tangency::live::{Server, Library};
//! use tangency::{Catalogue, output::SizeLimit};
//! let library = Library { catalogue: Catalogue::built_in(), folder: None, limit: SizeLimit::default() };
//! let server = Server::new(library, None, 0).expect("a free port");
//! println!("{}", server.address());
//! server.serve()
//! ```

mod attractors;
mod calls;
mod command;
mod connections;
mod describe;
mod details;
mod help;
mod http;
mod library;
mod opened;
mod pages;
mod plane;
mod preview;
mod server;
mod setup;
mod sweeping;
mod trouble;
mod work;

pub use library::Library;
pub use opened::Opened;
pub use server::Server;
pub use setup::Setup;

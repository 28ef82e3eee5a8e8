//! Pictures of branches, which are sent to the page while the branches are being traced.
//! A branch that was corrected beforehand is shown as corrected until its trace is complete.

use super::pages::Message;
use crate::core::cancel::CancelToken;
use crate::core::continuation::{Branch, Observer, Point};
use crate::output::{Document, Panel, Plot, diagram};
use crate::scene::SceneObserver;
use serde_json::json;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// The time until the first picture of unfinished branches is sent, and the time between two
/// pictures.
const FIRST: Duration = Duration::from_millis(8);
const NEXT: Duration = Duration::from_millis(30);

/// The maximum number of points in the picture of a branch that is still being traced.
const SHOWN: usize = 4_000;
/// The number of points after which the computation of branches is stopped, so that its result fits
/// into memory.
const MOST: usize = 500_000;

/// An observer that sends pictures of unfinished branches to the page, and stops a computation that
/// has too many points.
pub(super) struct Preview<'a> {
    /// The branches of the picture.
    document: Document,
    /// The branch that is being traced while the picture shows the corrected branch, with the index
    /// of the corrected branch.
    traced: Option<(usize, Branch)>,
    /// The chosen columns.
    axes: [Option<&'a str>; 2],
    out: &'a Sender<Message>,
    shown: bool,
    /// Whether the second half of the last branch, in the direction opposite to the first half, is
    /// being traced.
    backward: bool,
    next: Instant,
    points: usize,
    cancel: &'a CancelToken,
}

impl<'a> Preview<'a> {
    /// Creates an observer that draws branches on the axes of a plot, and cancels the token to stop
    /// the computation. The corrected branches are drawn at once.
    pub fn new(
        (plot, axes): (Plot, [Option<&'a str>; 2]),
        corrected: Vec<Branch>,
        (out, cancel): (&'a Sender<Message>, &'a CancelToken),
    ) -> Self {
        let mut document = Document::new("", corrected);
        // Deviations and enlargements need special points, which come later.
        document.plot = Plot { deviations: Vec::new(), ranges: Vec::new(), ..plot };
        let next = Instant::now() + FIRST;
        let (traced, shown, backward) = (None, true, false);
        let mut preview =
            Preview { document, traced, axes, out, shown, backward, next, points: 0, cancel };
        if !preview.document.branches.is_empty() {
            preview.draw();
        }
        preview
    }

    /// Sends a picture of the branches, if the last picture was sent long enough ago.
    fn send(&mut self) {
        if Instant::now() >= self.next {
            self.draw();
        }
    }

    /// Sends a picture of the branches.
    fn draw(&mut self) {
        let [x, y] = self.axes;
        let figure = diagram(&[("", &self.document)], x, y.as_slice());
        if let Ok(figure) = figure.and_then(|figure| figure.extent().map(|_| figure)) {
            let panel = Panel::new(&figure);
            let _ = self.out.send(Message::of(&json!({ "partial": panel })));
        }
        self.next = Instant::now() + NEXT;
    }
}

impl Observer for Preview<'_> {
    fn begin(&mut self, branch: &Branch) {
        self.backward = false;
        if let Some((corrected, complete)) = self.traced.take() {
            self.document.branches[corrected] = complete;
        }
        if self.shown {
            let branch = Branch { points: Vec::new(), special: Vec::new(), ..branch.clone() };
            let own = self.document.branches.iter().position(|it| it.name == branch.name);
            match own {
                Some(corrected) => self.traced = Some((corrected, branch)),
                None => self.document.branches.push(branch),
            }
        }
    }

    fn point(&mut self, point: &Point) {
        self.points += 1;
        if self.points > MOST {
            self.cancel.cancel();
        }
        if self.points > SHOWN {
            return;
        }
        let last = self.traced.as_mut().map(|(_, branch)| branch);
        let last = last.or(self.document.branches.last_mut()).filter(|_| self.shown);
        let Some(branch) = last else { return };
        // A branch is traced from its start to one end, and then from its start to the other end.
        let position = |point: &Point| point.slopes.as_ref().map(|slopes| slopes.position.abs());
        let last = if self.backward { branch.points.first() } else { branch.points.last() };
        self.backward |= last.and_then(position).is_some_and(|last| position(point) < Some(last));
        match self.backward {
            true => branch.points.insert(0, point.clone()),
            false => branch.points.push(point.clone()),
        }
        self.send();
    }
}

impl SceneObserver for Preview<'_> {
    fn run(&mut self, _run: &str, shown: bool) {
        self.shown = shown;
    }
}

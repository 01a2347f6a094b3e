//! A production's graph as text that reads like the paper's figures.
//!
//! There are two notations for the same kind of graph:
//! - `entry -> a -> (b | c -> d) -> exit`: one component after the other; parts in brackets,
//!   separated by bars, run side by side and join at the closing bracket.
//! - `entry -a-> 1 -b-> exit; entry -c-> 1`: edges between named vertices, for graphs that brackets
//!   cannot express.
//!
//! Names may contain spaces; in quotes they may contain anything. A name may occur on several
//! edges.

mod lexer;
mod parser;

use crate::toml::Span;
use plan_format::limits;
use std::borrow::Cow;

/// A production's right-hand side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// Number of vertices: 0 is the entry, the last one is the exit, and edges lead to higher
    /// numbers.
    pub vertices: u8,
    /// Names of the vertices that have one in the text.
    pub names: Vec<(String, u8)>,
    /// Edges in the order of the text.
    pub edges: Vec<GraphEdge>,
}

/// A component between two vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphEdge {
    /// Vertex that the edge leaves.
    pub from: u8,
    /// Vertex that the edge reaches.
    pub to: u8,
    /// Name of the component.
    pub component: String,
    /// Where the name is in the text.
    pub span: Span,
}

/// A mistake in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// What is wrong.
    pub message: String,
    /// Where, in bytes of the text.
    pub span: Span,
    /// Label of that place.
    pub label: String,
    /// How to fix it.
    pub help: String,
}

impl Mistake {
    fn new(message: impl Into<String>, span: &Span, label: &str, help: &str) -> Self {
        Self { message: message.into(), span: span.clone(), label: label.into(), help: help.into() }
    }
}

/// Reads a graph, or returns at least one mistake.
pub fn parse(text: &str) -> Result<Graph, Vec<Mistake>> {
    let tokens = lexer::tokens(text)?;
    let raw = parser::parse(&tokens, text.len())?;
    number(raw)
}

impl Graph {
    /// Whether a path leads from one vertex to another, or they are the same.
    pub fn leads(&self, from: u8, to: u8) -> bool {
        let mut reached = vec![false; usize::from(self.vertices)];
        if let Some(start) = reached.get_mut(usize::from(from)) {
            *start = true;
        }
        // Edges lead to higher numbers, so all edges into a vertex are seen before it.
        for vertex in from..self.vertices {
            if reached[usize::from(vertex)] {
                for edge in self.edges.iter().filter(|edge| edge.from == vertex) {
                    reached[usize::from(edge.to)] = true;
                }
            }
        }
        reached.get(usize::from(to)).copied().unwrap_or(false)
    }

    /// The number of the vertex with a name.
    pub fn vertex(&self, name: &str) -> Option<u8> {
        match name {
            "entry" => Some(0),
            "exit" => self.vertices.checked_sub(1),
            _ => self.names.iter().find(|(known, _)| known == name).map(|&(_, vertex)| vertex),
        }
    }
}

/// A graph whose vertices have no order yet: 0 is the entry, 1 the exit.
#[derive(Debug, Default)]
struct RawGraph {
    /// Name of each vertex, which may be empty, and where it was first written.
    vertices: Vec<(String, Span)>,
    edges: Vec<RawEdge>,
}

#[derive(Debug)]
struct RawEdge {
    from: usize,
    to: usize,
    component: String,
    span: Span,
}

const ENTRY: usize = 0;
const EXIT: usize = 1;

/// Numbers the vertices so that all edges lead to higher numbers, and checks that every edge lies
/// on a path from the entry to the exit.
fn number(raw: RawGraph) -> Result<Graph, Vec<Mistake>> {
    let mut mistakes = ends(&raw);
    let start = raw.edges.iter().map(|edge| edge.span.start).min().unwrap_or(0);
    let end = raw.edges.iter().map(|edge| edge.span.end).max().unwrap_or(0);
    let whole = start..end;
    if raw.edges.len() > limits::MAX_PRODUCTION_EDGES {
        mistakes.push(too_many(
            "components",
            raw.edges.len(),
            limits::MAX_PRODUCTION_EDGES,
            &whole,
        ));
    }
    if raw.vertices.len() > limits::MAX_VERTICES {
        mistakes.push(too_many("vertices", raw.vertices.len(), limits::MAX_VERTICES, &whole));
    }
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    let order = in_order(&raw).map_err(|mistake| vec![mistake])?;
    let place = |vertex: usize| order.iter().position(|&v| v == vertex).unwrap_or(0) as u8;
    let named = raw.vertices.iter().enumerate().skip(2).filter(|(_, (name, _))| !name.is_empty());
    Ok(Graph {
        vertices: order.len() as u8,
        names: named.map(|(vertex, (name, _))| (name.clone(), place(vertex))).collect(),
        edges: raw
            .edges
            .iter()
            .map(|edge| GraphEdge {
                from: place(edge.from),
                to: place(edge.to),
                component: edge.component.clone(),
                span: edge.span.clone(),
            })
            .collect(),
    })
}

fn too_many(what: &str, count: usize, limit: usize, span: &Span) -> Mistake {
    Mistake::new(
        format!("a production has at most {limit} {what}; this one has {count}"),
        span,
        "this graph",
        "move a part of it into a separate frame",
    )
}

/// Checks that no edge reaches the entry or leaves the exit, and that edges reach and leave every
/// other vertex.
fn ends(raw: &RawGraph) -> Vec<Mistake> {
    let mut mistakes = Vec::new();
    for edge in &raw.edges {
        if edge.to == ENTRY {
            let help = "for a loop, let the frame contain itself as its last component";
            mistakes.push(Mistake::new(
                "an edge leads into `entry`",
                &edge.span,
                "this edge",
                help,
            ));
        }
        if edge.from == EXIT {
            let help = "start the edge at another vertex";
            mistakes.push(Mistake::new("an edge leaves `exit`", &edge.span, "this edge", help));
        }
    }
    for (vertex, (name, span)) in raw.vertices.iter().enumerate() {
        let shown = match vertex {
            ENTRY => "entry",
            EXIT => "exit",
            _ => name,
        };
        if vertex != ENTRY && !raw.edges.iter().any(|edge| edge.to == vertex) {
            let message = format!("no edge leads to vertex `{shown}`");
            let help = "add an edge that ends there, or remove the vertex";
            mistakes.push(Mistake::new(message, span, "this vertex", help));
        }
        if vertex != EXIT && !raw.edges.iter().any(|edge| edge.from == vertex) {
            let message = format!("no edge leaves vertex `{shown}`");
            let help = "add an edge that begins there, or remove the vertex";
            mistakes.push(Mistake::new(message, span, "this vertex", help));
        }
    }
    mistakes
}

/// A topological order with the entry first and the exit last; ties keep the order of the text.
fn in_order(raw: &RawGraph) -> Result<Vec<usize>, Mistake> {
    let count = raw.vertices.len();
    let mut order = Vec::with_capacity(count);
    let written = (0..count).filter(|&vertex| vertex != EXIT).chain([EXIT]);
    let written: Vec<usize> = written.collect();
    while order.len() < count {
        let ready = |&&vertex: &&usize| {
            !order.contains(&vertex)
                && raw.edges.iter().all(|edge| edge.to != vertex || order.contains(&edge.from))
        };
        let Some(&next) = written.iter().find(ready) else {
            let is_left = |edge: &&RawEdge| !order.contains(&edge.from);
            let edge = raw.edges.iter().find(is_left);
            let span = edge.map_or(0..0, |edge| edge.span.clone());
            return Err(Mistake::new(
                "the graph contains a cycle",
                &span,
                "this edge is part of it",
                "for a loop, let the frame contain itself as its last component",
            ));
        };
        order.push(next);
    }
    Ok(order)
}

/// A name with its values in the one form in which copies are kept: `to(1,2)` is `to(1, 2)`.
pub(crate) fn tidy(name: &str) -> Cow<'_, str> {
    let inside = name.strip_suffix(')').and_then(|rest| rest.split_once('('));
    match inside {
        Some((name, values)) if !name.is_empty() => {
            let values: Vec<&str> = values.split(',').map(str::trim).collect();
            Cow::Owned(format!("{}({})", name.trim(), values.join(", ")))
        }
        _ => Cow::Borrowed(name),
    }
}

#[cfg(test)]
mod tests;

//! The parser: from tokens to a graph without an order.

use super::lexer::{Kind, Token};
use super::{ENTRY, EXIT, Mistake, RawEdge, RawGraph};
use crate::toml::Span;

/// Deepest nesting of brackets.
const MAX_NESTING: usize = 16;
const SEQUENCE: &str = "write for example entry -> a -> (b | c) -> exit";
const VERTICES: &str = "write for example entry -a-> 1 -b-> exit; entry -c-> 1";

pub(super) fn parse(tokens: &[Token], length: usize) -> Result<RawGraph, Vec<Mistake>> {
    let mut graph = RawGraph::default();
    graph.vertices.push((String::new(), 0..length));
    graph.vertices.push((String::new(), 0..length));
    let mut parser = Parser { tokens, at: 0, end: length, graph };
    let parsed = if tokens.iter().any(|token| token.kind == Kind::Dash) {
        parser.named_edges()
    } else {
        parser.whole_sequence()
    };
    parsed.map(|()| parser.graph).map_err(|mistake| vec![mistake])
}

struct Parser<'t> {
    tokens: &'t [Token],
    at: usize,
    end: usize,
    graph: RawGraph,
}

impl<'t> Parser<'t> {
    /// `entry -> ... -> exit`
    fn whole_sequence(&mut self) -> Result<(), Mistake> {
        self.word("entry", SEQUENCE)?;
        self.expect(&Kind::Arrow, "`->`", SEQUENCE)?;
        let mut items = vec![self.item_start()?];
        while self.take(&Kind::Arrow).is_some() {
            items.push(self.item_start()?);
        }
        if let Some(token) = self.tokens.get(self.at) {
            return Err(unexpected("`->` or the end of the graph", token, SEQUENCE));
        }
        match items.pop() {
            Some(Item::Name(name, _)) if name == "exit" => {}
            last => {
                let span = last.map_or(0..self.end, |item| item.span());
                let help = "let the last arrow lead to `exit`";
                return Err(Mistake::new(
                    "the graph does not end at `exit`",
                    &span,
                    "the end",
                    help,
                ));
            }
        }
        if items.is_empty() {
            return Err(nothing_between(self.end));
        }
        self.lay(&items, ENTRY, EXIT)
    }

    fn item_start(&mut self) -> Result<Item, Mistake> {
        self.item(0)
    }

    /// A name, or `( ... | ... )`.
    fn item(&mut self, nesting: usize) -> Result<Item, Mistake> {
        match self.tokens.get(self.at) {
            Some(Token { kind: Kind::Name(name), span }) => {
                self.at += 1;
                Ok(Item::Name(name.clone(), span.clone()))
            }
            Some(Token { kind: Kind::Open, span }) if nesting < MAX_NESTING => {
                self.at += 1;
                let mut branches = vec![self.sequence(nesting + 1)?];
                while self.take(&Kind::Bar).is_some() {
                    branches.push(self.sequence(nesting + 1)?);
                }
                let close = self.expect(&Kind::Close, "`|` or `)`", SEQUENCE)?;
                Ok(Item::Branches(branches, span.start..close.end))
            }
            Some(Token { kind: Kind::Open, span }) => {
                let message = format!("brackets are nested more than {MAX_NESTING} deep");
                let help = "move a part of the graph into a separate frame";
                Err(Mistake::new(message, span, "this bracket", help))
            }
            Some(token) => Err(unexpected("a component or `(`", token, SEQUENCE)),
            None => Err(self.ended("a component, or `exit`", SEQUENCE)),
        }
    }

    /// `a -> b`, inside brackets.
    fn sequence(&mut self, nesting: usize) -> Result<Vec<Item>, Mistake> {
        let mut items = vec![self.item(nesting)?];
        while self.take(&Kind::Arrow).is_some() {
            items.push(self.item(nesting)?);
        }
        Ok(items)
    }

    /// Puts items between two vertices, one after the other.
    fn lay(&mut self, items: &[Item], from: usize, to: usize) -> Result<(), Mistake> {
        let mut here = from;
        for (number, item) in items.iter().enumerate() {
            let is_last = number + 1 == items.len();
            let next = if is_last { to } else { self.vertex(String::new(), item.span()) };
            match item {
                Item::Name(name, span) if name == "entry" || name == "exit" => {
                    let help = "`entry` begins the graph and `exit` ends it, once each";
                    let message = format!("`{name}` is in the middle of the graph");
                    return Err(Mistake::new(message, span, "not a component", help));
                }
                Item::Name(name, span) => self.graph.edges.push(RawEdge {
                    from: here,
                    to: next,
                    component: name.clone(),
                    span: span.clone(),
                }),
                Item::Branches(branches, _) => {
                    for branch in branches {
                        self.lay(branch, here, next)?;
                    }
                }
            }
            here = next;
        }
        Ok(())
    }

    /// `entry -a-> 1 -b-> exit; ...`
    fn named_edges(&mut self) -> Result<(), Mistake> {
        loop {
            let mut from = self.named_vertex()?;
            loop {
                self.expect(&Kind::Dash, "`-` and a component", VERTICES)?;
                let (component, span) = self.name("a component", VERTICES)?;
                self.expect(&Kind::Arrow, "`->`", VERTICES)?;
                let to = self.named_vertex()?;
                self.graph.edges.push(RawEdge { from, to, component, span });
                from = to;
                match self.tokens.get(self.at) {
                    None => return Ok(()),
                    Some(token) if token.kind == Kind::Semicolon => break,
                    Some(_) => {}
                }
            }
            while self.take(&Kind::Semicolon).is_some() {}
            if self.at == self.tokens.len() {
                return Ok(());
            }
        }
    }

    fn named_vertex(&mut self) -> Result<usize, Mistake> {
        let (name, span) = self.name("a vertex", VERTICES)?;
        Ok(match name.as_str() {
            "entry" => ENTRY,
            "exit" => EXIT,
            _ => {
                let known = self.graph.vertices.iter().position(|(known, _)| *known == name);
                known.unwrap_or_else(|| self.vertex(name, span))
            }
        })
    }

    fn vertex(&mut self, name: String, span: Span) -> usize {
        self.graph.vertices.push((name, span));
        self.graph.vertices.len() - 1
    }

    fn name(&mut self, expected: &str, help: &str) -> Result<(String, Span), Mistake> {
        match self.tokens.get(self.at) {
            Some(Token { kind: Kind::Name(name), span }) => {
                self.at += 1;
                Ok((name.clone(), span.clone()))
            }
            Some(token) => Err(unexpected(expected, token, help)),
            None => Err(self.ended(expected, help)),
        }
    }

    fn word(&mut self, word: &str, help: &str) -> Result<(), Mistake> {
        let at = self.at;
        let (name, _) = self.name(&format!("`{word}`"), help)?;
        match self.tokens.get(at) {
            Some(token) if name != word => Err(unexpected(&format!("`{word}`"), token, help)),
            _ => Ok(()),
        }
    }

    fn take(&mut self, kind: &Kind) -> Option<Span> {
        let token = self.tokens.get(self.at).filter(|token| token.kind == *kind)?;
        self.at += 1;
        Some(token.span.clone())
    }

    fn expect(&mut self, kind: &Kind, expected: &str, help: &str) -> Result<Span, Mistake> {
        match (self.take(kind), self.tokens.get(self.at)) {
            (Some(span), _) => Ok(span),
            (None, Some(token)) => Err(unexpected(expected, token, help)),
            (None, None) => Err(self.ended(expected, help)),
        }
    }

    fn ended(&self, expected: &str, help: &str) -> Mistake {
        let last = self.tokens.last().map_or(0..self.end, |token| token.span.clone());
        Mistake::new(
            "the graph ends too early",
            &last,
            &format!("expected {expected} after this"),
            help,
        )
    }
}

/// A part of a sequence.
enum Item {
    Name(String, Span),
    Branches(Vec<Vec<Item>>, Span),
}

impl Item {
    fn span(&self) -> Span {
        match self {
            Self::Name(_, span) | Self::Branches(_, span) => span.clone(),
        }
    }
}

fn unexpected(expected: &str, token: &Token, help: &str) -> Mistake {
    let label = format!("expected {expected}");
    Mistake::new("the graph cannot be read here", &token.span, &label, help)
}

fn nothing_between(end: usize) -> Mistake {
    let help = "put at least one component between `entry` and `exit`";
    Mistake::new("the graph has no component", &(0..end), "nothing to do", help)
}

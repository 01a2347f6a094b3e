//! Text in, edges or mistakes out.

use super::*;
use proptest::prelude::*;

/// Checks the edges, as `0-a-1 1-b-2`, or the mistakes with the text that they point at.
#[track_caller]
fn check(text: &str, expected: &str) {
    let got = match parse(text) {
        Ok(graph) => {
            let edges = graph.edges.iter();
            let edges = edges.map(|edge| format!("{}-{}-{}", edge.from, edge.component, edge.to));
            let names = graph.names.iter().map(|(name, vertex)| format!("{name}={vertex}"));
            edges.chain(names).collect::<Vec<String>>().join(" ")
        }
        Err(mistakes) => mistakes
            .iter()
            .map(|m| format!("{} [{}]: {}", m.message, &text[m.span.clone()], m.label))
            .collect::<Vec<String>>()
            .join("; "),
    };
    assert_eq!(got, expected, "{text}");
}

#[test]
fn h04_components_stand_between_vertices() {
    check("entry -> a -> exit", "0-a-1");
    check("entry->a->b->exit", "0-a-1 1-b-2");
    check(
        "entry -> plough field -> 'to (the) gallon' -> go-home -> exit",
        "0-plough field-1 1-to (the) gallon-2 2-go-home-3",
    );
}

#[test]
fn h05_brackets_run_side_by_side_and_join() {
    check("entry -> (a | b) -> exit", "0-a-1 0-b-1");
    check("entry -> (a -> b | c) -> d -> exit", "0-a-1 1-b-2 0-c-2 2-d-3");
    check("entry -> (a | (b | c) -> d) -> exit", "0-a-2 0-b-1 0-c-1 1-d-2");
}

#[test]
fn named_vertices_say_what_brackets_cannot() {
    check(
        "entry -a-> 1 -b-> exit; entry -c-> 2 -d-> exit; 1 -e-> 2",
        "0-a-1 1-b-3 0-c-2 2-d-3 1-e-2 1=1 2=2",
    );
    // Vertices are put in order, however they are written.
    check("m -b-> exit; entry -a-> m;", "1-b-2 0-a-1 m=1");
}

#[test]
fn h03_mistakes_name_what_is_wrong() {
    check("", "the graph ends too early []: expected `entry` after this");
    check("a -> exit", "the graph cannot be read here [a]: expected `entry`");
    check("entry -> a", "the graph does not end at `exit` [a]: the end");
    check("entry -> exit", "the graph has no component [entry -> exit]: nothing to do");
    check(
        "entry -> (a | b -> exit",
        "the graph ends too early [exit]: expected `|` or `)` after this",
    );
    check(
        "entry -> a) -> exit",
        "the graph cannot be read here [)]: expected `->` or the end of the graph",
    );
    check(
        "entry -> a -> entry -> exit",
        "`entry` is in the middle of the graph [entry]: not a component",
    );
    check("entry -> a ! b -> exit", "`!` is not allowed in a graph [!]: this character");
    check("entry -> a => b -> exit", "`=>` is not allowed in a graph [=>]: these characters");
    check(
        "entry -> to (1, 2) -> (a | b) -> exit",
        "the values of `to` follow after a space [to (1, 2)]: this name",
    );
    check("entry -> 'a -> exit", "a quote is not closed ['a -> exit]: from here");
    check(
        "entry -a-> exit -b-> 1",
        "an edge leaves `exit` [b]: this edge; no edge leaves vertex `1` [1]: this vertex",
    );
    check(
        "1 -a-> exit",
        "no edge leaves vertex `entry` [1 -a-> exit]: this vertex; no edge leads to vertex `1` [1]: this vertex",
    );
    check(
        "entry -a-> 1 -b-> 2 -c-> 1; 2 -d-> exit",
        "the graph contains a cycle [b]: this edge is part of it",
    );
    check("entry -a- 1", "the graph cannot be read here [-]: expected `->`");
}

#[test]
fn a_graph_larger_than_the_robots_is_refused() {
    let many = |count: usize| format!("entry -> {} -> exit", vec!["a"; count].join(" -> "));
    assert!(parse(&many(limits::MAX_VERTICES - 1)).is_ok());
    let mistakes = parse(&many(limits::MAX_VERTICES)).unwrap_err();
    assert_eq!(mistakes[0].message, "a production has at most 16 vertices; this one has 17");
    let parallel = format!("entry -> ({}) -> exit", vec!["a"; 17].join(" | "));
    let mistakes = parse(&parallel).unwrap_err();
    assert_eq!(mistakes[0].message, "a production has at most 16 components; this one has 17");
    let deep = format!("entry -> {}a{} -> exit", "(".repeat(10_000), ")".repeat(10_000));
    assert_eq!(parse(&deep).unwrap_err()[0].message, "brackets are nested more than 16 deep");
}

proptest! {
    #[test]
    fn no_text_makes_it_panic_and_every_graph_is_sound(
        text in "([a-c ]|->|-|\\(|\\)|\\||;|entry|exit|'|é|\"){0,24}",
    ) {
        match parse(&text) {
            Ok(graph) => {
                let last = graph.vertices - 1;
                for edge in &graph.edges {
                    prop_assert!(edge.from < edge.to && edge.to <= last, "{graph:?}");
                    prop_assert!(graph.leads(0, edge.from) && graph.leads(edge.to, last));
                }
            }
            Err(mistakes) => {
                prop_assert!(!mistakes.is_empty());
                for mistake in mistakes {
                    prop_assert!(text.get(mistake.span.clone()).is_some(), "{mistake:?}");
                }
            }
        }
    }

    /// The notation with brackets means the same as the one with named vertices.
    #[test]
    fn both_ways_of_writing_give_the_same_sequence(count in 1_usize..14) {
        let names: Vec<String> = (0..count).map(|index| format!("c{index}")).collect();
        let brackets = parse(&format!("entry -> {} -> exit", names.join(" -> "))).unwrap();
        let mut named = "entry".to_owned();
        for (index, name) in names.iter().enumerate() {
            let vertex = if index + 1 == count { "exit".to_owned() } else { format!("v{index}") };
            named += &format!(" -{name}-> {vertex}");
        }
        let named = parse(&named).unwrap();
        let plain = |graph: &Graph| -> Vec<(u8, u8, String)> {
            graph.edges.iter().map(|e| (e.from, e.to, e.component.clone())).collect()
        };
        prop_assert_eq!(plain(&brackets), plain(&named));
    }
}

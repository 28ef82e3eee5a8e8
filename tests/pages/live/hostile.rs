//! Requests that the page would never send: each is refused or cancelled, and the server answers
//! the next one.

use super::Program;
use super::session::FOLD;
use serde_json::json;
use std::io::Write;
use std::net::TcpStream;

/// The numbers of requests with changed bytes, and of changes of a parameter.
const FUZZED: u64 = 2000;
const CHANGES: u32 = 1000;

fn status(response: &str) -> &str {
    response.split(' ').nth(1).unwrap_or_default()
}

/// A call that traces the fold, with the number of the trace.
fn trace(text: &str, turn: u32, k: f64) -> Vec<u8> {
    let setup = json!({ "name": "t", "text": text, "set": [["k", k.to_string()]] });
    json!({ "trace": { "page": "p", "turn": turn, "setup": setup } }).to_string().into_bytes()
}

fn works(program: &Program) {
    let response = program.call(br#"{"alive":{}}"#);
    assert_eq!(status(&response), "200", "{response}");
}

#[test]
fn only_the_page_is_answered() {
    let program = Program::start(&[]);
    let (host, token) = program.parts();
    let get = |path: &str, host: &str, more: &str| {
        let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n");
        status(&program.raw(request.as_bytes())).to_string()
    };
    let page = format!("/{token}/");
    assert_eq!(get(&page, &host, ""), "200");
    let wrong = format!("/{}/", token.replace(|c: char| c.is_ascii_digit(), "f"));
    for path in ["/", "/favicon.ico", "/x/", "//", &wrong, &format!("/{token}/../../etc/passwd")] {
        assert_eq!(get(path, &host, ""), "404", "{path}");
    }
    let port = host.rsplit(':').next().unwrap();
    for foreign in ["evil.example", &format!("evil.example:{port}"), "127.0.0.1:1", ""] {
        assert_eq!(get(&page, foreign, ""), "403", "{foreign}");
    }
    assert_eq!(get(&page, &host, "Origin: http://evil.example\r\n"), "403");
    assert_eq!(get(&page, &host, "Origin: null\r\n"), "403");
    let post = |headers: &str| {
        let request = format!(
            "POST /{token}/call HTTP/1.1\r\nHost: {host}\r\n{headers}Content-Length: 12\r\n\r\n{{\"alive\":{{}}}}"
        );
        status(&program.raw(request.as_bytes())).to_string()
    };
    let own = format!("Origin: http://{host}\r\n");
    let json = "Content-Type: application/json\r\n";
    assert_eq!(post(&format!("{own}{json}")), "200");
    // Forms and other pages can send a request without the type or with another origin.
    assert_eq!(post(&own), "403");
    assert_eq!(post(json), "403");
    assert_eq!(post(&format!("{own}Content-Type: text/plain\r\n")), "403");
    assert_eq!(post(&format!("Origin: http://evil.example\r\n{json}")), "403");
    works(&program);
}

#[test]
fn large_and_malformed_requests_are_refused() {
    let program = Program::start(&[]);
    let (host, token) = program.parts();
    let head = |length: &str| {
        format!(
            "POST /{token}/call HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Type: application/json\r\n{length}\r\n\r\n"
        )
    };
    let large = format!("Content-Length: {}", 100 << 20);
    let body = vec![b'x'; 100 << 20];
    let response = program.raw(&[head(&large).as_bytes(), &body].concat());
    assert!(["413", ""].contains(&status(&response)), "{response}");
    assert_eq!(status(&program.raw(head(&large).as_bytes())), "413");
    assert_eq!(status(&program.raw(head("Transfer-Encoding: chunked").as_bytes())), "413");
    for length in
        ["Content-Length: -1", "Content-Length: 1x", "Content-Length: 1\r\nContent-Length: 2"]
    {
        assert_eq!(status(&program.raw(head(length).as_bytes())), "400", "{length}");
    }
    let long = format!("GET / HTTP/1.1\r\nHost: {}\r\n\r\n", "h".repeat(100_000));
    assert!(["431", ""].contains(&status(&program.raw(long.as_bytes()))));
    assert_eq!(
        status(&program.raw(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n")),
        "400"
    );
    let deep = "[".repeat(1 << 20);
    for body in [
        "",
        "{",
        "null",
        "{\"trace\":{}}",
        "{\"alive\":{\"x\":1}}",
        "{\"file\":{\"page\":\"p\"}}",
        &deep,
    ] {
        assert_eq!(status(&program.call(body.as_bytes())), "400", "{:.40}", body);
    }
    works(&program);
}

#[test]
fn a_thousand_connections_do_not_keep_the_page_out() {
    let program = Program::start(&[]);
    let connections: Vec<TcpStream> = (0..1000)
        .filter_map(|k| {
            let mut stream = TcpStream::connect(program.parts().0).ok()?;
            // Some send nothing, some the beginning of a request.
            if k % 2 == 0 {
                let _ = stream.write_all(b"GET / HTTP/1.1\r\nHost:");
            }
            Some(stream)
        })
        .collect();
    assert!(connections.len() > 500);
    works(&program);
    let response = program.call(&trace(FOLD, 1, 2.0));
    assert!(response.contains("\"done\"") && response.contains("\"load = 0.5\""), "{response}");
}

#[test]
fn a_trace_without_end_gives_way_to_the_next_one() {
    let program = Program::start(&[]);
    let (host, token) = program.parts();
    // A stiff motion that never settles, and a long branch.
    let endless = "x' = y\ny' = mu*(1 - x^2)*y - x + 0*a\npar a=0, mu=1e7\ninit x=2\n";
    let many = "x' = a - x + sin(1e6*a)\npar a=0, k=1\n";
    for (turn, text) in [(1, endless), (2, many)] {
        let body = trace(text, turn, 1.0);
        let head = format!(
            "POST /{token}/call HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n",
            body.len()
        );
        program.connect().write_all(&[head.as_bytes(), &body].concat()).unwrap();
    }
    let response = program.call(&trace(FOLD, 3, 2.0));
    assert!(response.contains("\"load = 0.5\""), "{response}");
    // An old change does not replace a later one.
    assert!(program.call(&trace(FOLD, 2, 5.0)).contains("superseded"));
}

/// Requests with changed bytes, and the memory after many changes.
#[test]
fn fuzzed_messages_are_answered_and_memory_is_stable() {
    let program = Program::start(&[]);
    let mut state = 88_172_645_463_325_252_u64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    for turn in 0..FUZZED {
        let mut body = trace(FOLD, turn as u32 + 1, 1.0);
        for _ in 0..=random() % 4 {
            let at = (random() as usize) % body.len();
            match random() % 3 {
                0 => body[at] = (random() % 256) as u8,
                1 => drop(body.remove(at)),
                _ => body.insert(at, b"\"{}[],:-e0"[(random() % 10) as usize]),
            }
        }
        let response = program.call(&body);
        assert!(["200", "400"].contains(&status(&response)), "{response}");
    }
    let mut before = 0;
    for turn in 0..CHANGES {
        let k = 1.0 + f64::from(turn % 100) / 100.0;
        let response = program.call(&trace(FOLD, 1_000_000 + turn, k));
        assert!(response.contains("\"done\""), "{response}");
        if turn == CHANGES / 2 {
            before = program.memory();
        }
    }
    let after = program.memory();
    assert!(after < before + 20_000, "{before} kB, then {after} kB");
}

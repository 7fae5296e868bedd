//! Requests and answers in gzip, the digest of answers, and equal bytes for equal requests.

use std::io::{Read, Write};

use axum::body::Body;
use axum::http::Request;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};

use super::support::{Answer, MILL, ONE_PASS, app, get, post, send};

const DIE: &str = include_str!("../../../openapi/examples/surfaces-mill/die.json");

fn gzip(text: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(text).expect("writing to memory does not fail");
    encoder.finish().expect("writing to memory does not fail")
}

fn gunzip(answer: &Answer) -> Vec<u8> {
    assert_eq!(answer.header("content-encoding"), "gzip");
    let mut decoded = Vec::new();
    GzDecoder::new(answer.body.as_slice()).read_to_end(&mut decoded).expect("gzip");
    decoded
}

const CODED: (&str, &str) = ("content-encoding", "gzip");

#[tokio::test]
async fn a_gzip_body_is_read_under_the_content_types_that_curl_sends() {
    let app = app(&["--workers", "1"]);
    let plain = post(&app, &format!("{MILL}?format=gcode"), ONE_PASS, &[]).await;
    assert_eq!(plain.status, 200);
    for content_type in ["application/json", "application/x-www-form-urlencoded"] {
        for (coding, body) in [
            ("identity", ONE_PASS.into()),
            ("gzip", gzip(ONE_PASS.as_bytes())),
            ("GZIP", gzip(ONE_PASS.as_bytes())),
        ] {
            let request = Request::post(format!("{MILL}?format=gcode"))
                .header("content-type", content_type)
                .header("content-encoding", coding);
            let answer = send(&app, request.body(Body::from(body)).expect("a request")).await;
            assert_eq!(answer.body, plain.body, "{content_type} {coding}: another program");
        }
    }
}

#[tokio::test]
async fn the_body_limit_counts_bytes_after_decompression() {
    let app = app(&["--workers", "1", "--body-limit", "100000"]);
    let bomb = gzip(&vec![b' '; 50_000_000]);
    assert!(bomb.len() < 100_000, "the compressed body has {} bytes", bomb.len());
    let answer = post(&app, MILL, bomb, &[CODED]).await;
    assert_eq!((answer.status.as_u16(), answer.code().as_str()), (413, "payload_too_large"));
    assert!(answer.problem()["detail"].as_str().is_some_and(|detail| detail.contains("100000")));
    let padded = format!("{ONE_PASS}{}", " ".repeat(100_000 - ONE_PASS.len()));
    assert_eq!(post(&app, MILL, gzip(padded.as_bytes()), &[CODED]).await.status, 200);
    let over = post(&app, MILL, gzip(format!("{padded} ").as_bytes()), &[CODED]).await;
    assert_eq!(over.status, 413);
}

#[tokio::test]
async fn broken_gzip_is_400_and_other_content_encodings_are_415() {
    let app = app(&["--workers", "1"]);
    let coded = gzip(ONE_PASS.as_bytes());
    for body in
        [&coded[..coded.len() / 2], &coded[..coded.len() - 1], ONE_PASS.as_bytes(), &b"\x1f\x8b"[..], &[]]
    {
        let answer = post(&app, MILL, body.to_vec(), &[CODED]).await;
        assert_eq!((answer.status.as_u16(), answer.code().as_str()), (400, "bad_request"));
    }
    let text = post(&app, MILL, gzip(b"nothing"), &[CODED]).await;
    assert_eq!((text.status.as_u16(), text.code().as_str()), (400, "malformed_json"));
    for coding in ["br", "deflate", "gzip, gzip", ""] {
        let answer = post(&app, MILL, coded.clone(), &[("content-encoding", coding)]).await;
        assert_eq!((answer.status.as_u16(), answer.code().as_str()), (415, "unsupported_coding"), "{coding}");
        assert_eq!(answer.header("accept-encoding"), "gzip");
    }
}

#[tokio::test]
async fn repr_digest_is_the_sha_256_of_the_bytes_sent_in_every_format_and_content_encoding() {
    let app = app(&["--workers", "1"]);
    for format in ["json", "gcode", "svg", "html"] {
        let path = format!("{MILL}?format={format}");
        let ask = async |coding: &str| {
            post(&app, &path, DIE, &[("accept-encoding", coding), ("x-request-id", "one")]).await
        };
        let plain = ask("identity").await;
        assert_eq!(plain.header("content-encoding"), "");
        let coded = ask("br, gzip;q=0.5").await;
        assert_eq!(gunzip(&coded), plain.body, "{format}: compression changes the answer");
        for answer in [plain, coded] {
            let digest = BASE64_STANDARD.encode(Sha256::digest(&answer.body));
            assert_eq!(
                answer.header("repr-digest"),
                format!("sha-256=:{digest}:"),
                "{format}: another digest"
            );
            assert_eq!(answer.header("vary"), "Accept, Accept-Encoding");
            let steps = answer
                .header("server-timing")
                .split(", ")
                .map(|step| step.split_once(";dur=").expect("a time"));
            let names: Vec<_> = steps
                .map(|(name, time)| {
                    assert!(
                        time.parse::<f64>().is_ok_and(|time| time >= 0.0),
                        "the time of {name} is {time}"
                    );
                    name.to_owned()
                })
                .collect();
            assert_eq!(names, ["queue", "parse", "compute", "encode"]);
        }
    }
}

#[tokio::test]
async fn large_fixed_answers_are_compressed_and_small_answers_and_problems_are_not() {
    let app = app(&["--workers", "1"]);
    let ask = async |path: &str| {
        let request = Request::get(path).header("accept-encoding", "gzip");
        send(&app, request.body(Body::empty()).expect("a request")).await
    };
    assert_eq!(gunzip(&ask("/openapi.json").await), get(&app, "/openapi.json").await.body);
    assert_eq!(ask("/livez").await.body, b"ok\n");
    let small = post(&app, &format!("{MILL}?format=gcode"), ONE_PASS, &[("accept-encoding", "gzip")]).await;
    assert!(small.header("content-encoding").is_empty() && small.body.len() < 1024);
    assert_eq!(ask("/v1/nothing").await.code(), "not_found");
    let problem = post(&app, MILL, "{}", &[("accept-encoding", "gzip")]).await;
    assert_eq!((problem.code().as_str(), problem.header("repr-digest")), ("invalid_request", ""));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_hundred_requests_at_once_get_the_same_bytes_on_one_thread_and_on_two() {
    let mut seen: Option<Vec<u8>> = None;
    for workers in ["1", "2"] {
        let app = app(&["--workers", workers, "--queue", "100"]);
        let asked: Vec<_> = (0..100)
            .map(|k| {
                let app = std::sync::Arc::clone(&app);
                tokio::spawn(async move {
                    let id = format!("request-{k:03}");
                    let answer = post(&app, MILL, ONE_PASS, &[("x-request-id", &id)]).await;
                    assert_eq!(answer.status, 200);
                    String::from_utf8(answer.body).expect("UTF-8").replace(&id, "")
                })
            })
            .collect();
        for answer in asked {
            let body = answer.await.expect("an answer").into_bytes();
            assert!(
                *seen.get_or_insert_with(|| body.clone()) == body,
                "another answer with {workers} workers"
            );
        }
    }
}

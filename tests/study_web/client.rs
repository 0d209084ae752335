//! A browser without scripts, in a hundred lines.

use flate2::read::GzDecoder;
use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};

/// A reply.
#[derive(Debug, Clone)]
pub(crate) struct Reply {
    pub(crate) status: u16,
    pub(crate) headers: Vec<(String, String)>,
    /// Unpacked.
    pub(crate) body: String,
}

impl Reply {
    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.iter().find(|(own, _)| own == name).map_or("", |(_, value)| value)
    }

    /// The value of an attribute where it comes first; empty if it does not.
    pub(crate) fn attribute(&self, name: &str) -> String {
        let Some((_, rest)) = self.body.split_once(&format!(" {name}=\"")) else { return String::new() };
        rest.split('"').next().unwrap().to_owned()
    }

    /// Questions with the values that can be chosen; none of fields to write in, whose kind comes instead.
    pub(crate) fn questions(&self) -> Vec<(String, Vec<String>)> {
        let blocks = self.body.split("data-question=\"").skip(1);
        let question = |block: &str| {
            let id = block.split('"').next().unwrap().to_owned();
            let radios = block.split("type=\"radio\"").skip(1);
            let value =
                |radio: &str| radio.split("value=\"").nth(1).unwrap().split('"').next().unwrap().to_owned();
            let mut values: Vec<String> = radios.map(value).collect();
            if values.is_empty() {
                values.push(if block.contains("<textarea") { "a few words" } else { "33" }.to_owned());
            }
            (id, values)
        };
        blocks.map(question).collect()
    }

    /// Hidden fields of the form with a page's answers.
    pub(crate) fn hidden(&self) -> Vec<(String, String)> {
        let form =
            self.body.split("id=\"answers\"").nth(1).unwrap_or_default().split("</form>").next().unwrap();
        let field = |input: &str| {
            let of = |name: &str| {
                input.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap().to_owned()
            };
            (of("name"), of("value"))
        };
        form.split("<input type=\"hidden\"").skip(1).map(field).collect()
    }
}

/// A browser: its cookies, and all that it was sent.
#[derive(Debug)]
pub(crate) struct Browser {
    pub(crate) address: SocketAddr,
    pub(crate) cookies: BTreeMap<String, String>,
    /// Headers that every request has besides.
    pub(crate) extra: Vec<(String, String)>,
    pub(crate) received: Vec<String>,
}

impl Browser {
    pub(crate) fn new(address: SocketAddr) -> Self {
        Self { address, cookies: BTreeMap::new(), extra: Vec::new(), received: Vec::new() }
    }

    fn origin(&self) -> String {
        format!("http://{}", self.address)
    }

    pub(crate) fn get(&mut self, path: &str) -> Reply {
        self.send(&format!("GET {path} HTTP/1.1\r\n"), &[], "")
    }

    /// The same, with redirections.
    pub(crate) fn open(&mut self, path: &str) -> Reply {
        let reply = self.get(path);
        self.follow(reply)
    }

    pub(crate) fn follow(&mut self, reply: Reply) -> Reply {
        let mut reply = reply;
        for _ in 0..5 {
            if reply.status != 303 {
                return reply;
            }
            reply = self.get(reply.header("location"));
        }
        panic!("too many redirections: {reply:?}");
    }

    /// Sends a form as a browser does.
    pub(crate) fn post(&mut self, path: &str, fields: &[(&str, &str)]) -> Reply {
        let body: Vec<String> =
            fields.iter().map(|(name, value)| format!("{}={}", encode(name), encode(value))).collect();
        let origin = self.origin();
        let headers = [
            ("origin", origin.as_str()),
            ("sec-fetch-site", "same-origin"),
            ("content-type", "application/x-www-form-urlencoded"),
        ];
        self.send(&format!("POST {path} HTTP/1.1\r\n"), &headers, &body.join("&"))
    }

    /// Sends JSON as a page's script does.
    pub(crate) fn json(&mut self, path: &str, mark: &str, body: &str) -> Reply {
        let origin = self.origin();
        let headers = [
            ("origin", origin.as_str()),
            ("sec-fetch-site", "same-origin"),
            ("content-type", "application/json"),
            ("x-participation", mark),
        ];
        self.send(&format!("POST {path} HTTP/1.1\r\n"), &headers, body)
    }

    /// Sends a request with these headers and this body.
    pub(crate) fn send(&mut self, line: &str, headers: &[(&str, &str)], body: &str) -> Reply {
        let mut request = format!("{line}connection: close\r\naccept-encoding: gzip\r\n");
        let has_host = headers.iter().any(|(name, _)| *name == "host");
        if !has_host {
            request += &format!("host: {}\r\n", self.address);
        }
        let extra = self.extra.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        for (name, value) in headers.iter().copied().chain(extra) {
            request += &format!("{name}: {value}\r\n");
        }
        if !self.cookies.is_empty() {
            let all: Vec<String> =
                self.cookies.iter().map(|(name, value)| format!("{name}={value}")).collect();
            request += &format!("cookie: {}\r\n", all.join("; "));
        }
        if line.starts_with("POST") {
            request += &format!("content-length: {}\r\n", body.len());
        }
        request += "\r\n";
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        // a server that refuses a body may close before it has read it
        let _ = stream.write_all(body.as_bytes());
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        self.take(&bytes)
    }

    fn take(&mut self, bytes: &[u8]) -> Reply {
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap_or_else(|| panic!("no reply"));
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let mut lines = head.lines();
        let status = lines.next().unwrap().split(' ').nth(1).unwrap().parse().unwrap();
        let headers: Vec<(String, String)> = lines
            .map(|line| line.split_once(": ").unwrap())
            .map(|(name, value)| (name.to_lowercase(), value.to_owned()))
            .collect();
        for (_, cookie) in headers.iter().filter(|(name, _)| name == "set-cookie") {
            let (name, value) = cookie.split(';').next().unwrap().split_once('=').unwrap();
            self.cookies.insert(name.to_owned(), value.to_owned());
        }
        let is_packed = headers.contains(&("content-encoding".to_owned(), "gzip".to_owned()));
        let mut body = Vec::new();
        if is_packed {
            GzDecoder::new(&bytes[end + 4..]).read_to_end(&mut body).unwrap();
        } else {
            body.extend(&bytes[end + 4..]);
        }
        let body = String::from_utf8_lossy(&body).into_owned();
        self.received.push(format!("{head}\n\n{body}"));
        Reply { status, headers, body }
    }
}

fn encode(text: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte);
    text.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

//! URIs of buffers and images: data URIs are decoded here, relative ones prepared for the resolver.

/// What a URI asks for.
#[derive(Debug, PartialEq)]
pub(crate) enum Uri {
    /// The bytes of a data URI.
    Data(Vec<u8>),
    /// A relative path, percent-decoded.
    File(String),
}

/// Understands a URI; the error is a cause.
pub(crate) fn parse(uri: &str) -> Result<Uri, String> {
    if let Some(rest) = uri.strip_prefix("data:") {
        let (head, body) = rest
            .split_once(',')
            .ok_or("is a data URI without a comma")?;
        let bytes = if head.to_ascii_lowercase().ends_with(";base64") {
            base64(body.as_bytes()).ok_or("is a data URI whose base64 is broken")?
        } else {
            percent(body)
        };
        return Ok(Uri::Data(bytes));
    }
    if let Some(colon) = uri.find(':')
        && uri[..colon]
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    {
        return Err(format!(
            "has the scheme \"{}\"; only relative paths and data URIs are read",
            &uri[..colon]
        ));
    }
    if uri.is_empty() || uri.contains('\0') {
        return Err("is not a path".to_owned());
    }
    String::from_utf8(percent(uri))
        .map(Uri::File)
        .map_err(|_| "is not UTF-8 after percent-decoding".to_owned())
}

/// `%41` to `A`; anything that is not an escape stays.
fn percent(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let digit = |i: usize| bytes.get(i).and_then(|&b| (b as char).to_digit(16));
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], digit(i + 1), digit(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    out
}

/// RFC 4648 with or without padding, both alphabets.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let end = text.iter().rposition(|&b| b != b'=').map_or(0, |i| i + 1);
    let text = &text[..end];
    if text.len() % 4 == 1 {
        return None;
    }
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for quad in text.chunks(4) {
        let mut bits = 0u32;
        for &byte in quad {
            let six = match byte {
                b'A'..=b'Z' => byte - b'A',
                b'a'..=b'z' => byte - b'a' + 26,
                b'0'..=b'9' => byte - b'0' + 52,
                b'+' | b'-' => 62,
                b'/' | b'_' => 63,
                _ => return None,
            };
            bits = bits << 6 | u32::from(six);
        }
        bits <<= 6 * (4 - quad.len());
        out.extend_from_slice(&bits.to_be_bytes()[1..quad.len()]);
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_the_bytes_of_rfc_4648() {
        for (text, bytes) in [
            ("", &b""[..]),
            ("Zg==", b"f"),
            ("Zm8=", b"fo"),
            ("Zm9v", b"foo"),
            ("Zm9vYmFy", b"foobar"),
            ("Zm9vYg", b"foob"),
            ("-_-_", b"\xfb\xff\xbf"),
        ] {
            assert_eq!(base64(text.as_bytes()).as_deref(), Some(bytes), "{text}");
        }
        assert_eq!(base64(b"Zm9vY"), None);
        assert_eq!(base64(b"Zm 9"), None);
    }

    #[test]
    fn schemes_are_refused_and_escapes_decoded() {
        assert!(parse("http://example.org/a.bin").is_err());
        assert!(parse("file:///etc/hosts").is_err());
        assert!(parse("C:/x.bin").is_err());
        assert!(parse("").is_err());
        assert_eq!(
            parse("my%20file.bin"),
            Ok(Uri::File("my file.bin".to_owned()))
        );
        assert_eq!(parse("100%.bin"), Ok(Uri::File("100%.bin".to_owned())));
        assert_eq!(
            parse("data:application/octet-stream;base64,Zm9v"),
            Ok(Uri::Data(b"foo".to_vec()))
        );
        assert_eq!(parse("data:,a%62"), Ok(Uri::Data(b"ab".to_vec())));
    }
}

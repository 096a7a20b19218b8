//! URIs of buffers and images: data URIs are decoded here, paths prepared for the resolver.

use std::borrow::Cow;

use base64::Engine;
use base64::alphabet::{STANDARD, URL_SAFE};
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

/// What a URI asks for.
#[derive(Debug, PartialEq)]
pub(crate) enum Uri {
    /// The bytes of a data URI.
    Data(Vec<u8>),
    /// A path, percent-decoded.
    File(String),
}

/// What follows the scheme of a data URI; schemes may be written in capitals.
fn after_data(uri: &str) -> Option<&str> {
    let (scheme, rest) = uri.split_once(':')?;
    scheme.eq_ignore_ascii_case("data").then_some(rest)
}

/// Whether a URI holds its bytes itself.
pub(crate) fn is_data(uri: &str) -> bool {
    after_data(uri).is_some()
}

/// Understands a URI; the error is a cause.
pub(crate) fn parse(uri: &str) -> Result<Uri, String> {
    if let Some(rest) = after_data(uri) {
        let (head, body) = rest
            .split_once(',')
            .ok_or("is a data URI without a comma")?;
        // RFC 2397: escapes stand before base64.
        let body: Cow<'_, [u8]> = percent_decode_str(body).into();
        let last = head.rsplit_once(';').map_or("", |(_, last)| last.trim());
        let bytes = if last.eq_ignore_ascii_case("base64") {
            base64(&body).ok_or("is a data URI whose base64 is broken")?
        } else {
            body.into_owned()
        };
        return Ok(Uri::Data(bytes));
    }
    if let Some(colon) = uri.find(':')
        && uri[..colon]
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    {
        return Err(format!(
            "has the scheme \"{}\"; only paths and data URIs are read",
            &uri[..colon]
        ));
    }
    if uri.is_empty() || uri.contains('\0') {
        return Err("is not a path".to_owned());
    }
    let path: Cow<'_, [u8]> = percent_decode_str(uri).into();
    String::from_utf8(path.into_owned())
        .map(Uri::File)
        .map_err(|_| "is not UTF-8 after percent-decoding".to_owned())
}

/// RFC 4648 with or without padding, in either alphabet.
fn base64(mut text: &[u8]) -> Option<Vec<u8>> {
    let options = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::RequireNone)
        .with_decode_allow_trailing_bits(true);
    let alphabet = if text.contains(&b'-') || text.contains(&b'_') {
        &URL_SAFE
    } else {
        &STANDARD
    };
    let engine = GeneralPurpose::new(alphabet, options);
    while let [rest @ .., b'='] = text {
        text = rest;
    }
    engine.decode(text).ok()
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
        let cause = "has the scheme \"file\"; only paths and data URIs are read";
        assert_eq!(parse("file:///etc/hosts"), Err(cause.to_owned()));
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

    #[test]
    fn data_uris_are_read_in_each_way_that_rfc_2397_lets_them_be_written() {
        for uri in [
            "data:application/octet-stream;base64,+/8A",
            "data:application/octet-stream;base64,%2B%2F8A",
            "data:application/octet-stream;base64,%2b/8A%3D",
            "DATA:application/octet-stream;base64,+/8A",
            "Data:;BASE64,+/8A",
            "data:application/octet-stream; base64,+/8A",
            "data:text/plain;charset=x;base64 ,+/8A",
        ] {
            assert!(is_data(uri), "{uri}");
            assert_eq!(parse(uri), Ok(Uri::Data(vec![0xFB, 0xFF, 0])), "{uri}");
        }
        // A type or parameter of this name is none.
        for uri in ["data:base64,Zg", "data:a/b;base64=1,Zg"] {
            assert_eq!(parse(uri), Ok(Uri::Data(b"Zg".to_vec())), "{uri}");
        }
        assert!(parse("data:;base64,%2").is_err());
        assert!(!is_data("data/a.bin") && !is_data("database:a"));
    }
}

//! Tables as files (RFC 4180), for people who open them in a spreadsheet.

/// A table with its head. Excel reads Chinese only behind a byte order mark.
pub(crate) fn csv(head: &[String], rows: &[Vec<String>]) -> String {
    let mut text = String::from('\u{FEFF}');
    for row in std::iter::once(head).chain(rows.iter().map(Vec::as_slice)) {
        let cells: Vec<String> = row.iter().map(|cell| quoted(cell)).collect();
        text.push_str(&cells.join(","));
        text.push_str("\r\n");
    }
    text
}

/// A cell. What would be taken for a formula is told to be a text: a name comes from anybody's file.
fn quoted(cell: &str) -> String {
    let is_number = cell.strip_prefix('-').is_some_and(|rest| rest.parse::<f64>().is_ok());
    let formula = cell.starts_with(['=', '+', '@', '\t', '\r']) || cell.starts_with('-') && !is_number;
    let cell = if formula { ["'", cell].concat() } else { cell.to_owned() };
    if cell.contains([',', '"', '\n', '\r', ';']) { ["\"", &cell.replace('"', "\"\""), "\""].concat() } else { cell }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_come_back_as_they_were() {
        let head = ["a".to_owned(), "名称".to_owned()];
        let rows = [vec!["1,5".to_owned(), "say \"so\"".to_owned()], vec!["-0.328".to_owned(), String::new()]];
        assert_eq!(csv(&head, &rows), "\u{FEFF}a,名称\r\n\"1,5\",\"say \"\"so\"\"\"\r\n-0.328,\r\n");
    }

    #[test]
    fn a_name_is_never_a_formula() {
        for (cell, written) in
            [("=1+1", "'=1+1"), ("@x", "'@x"), ("-x", "'-x"), ("-4.661", "-4.661"), ("press 4", "press 4")]
        {
            assert_eq!(quoted(cell), written);
        }
    }
}

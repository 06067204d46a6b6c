//! Counting in the output of `cargo test`, which has no stable machine-readable form.

/// The sums over all test binaries of one `cargo test`.
#[derive(Debug, Default, PartialEq)]
pub struct Totals {
    /// Tests that passed, those that skipped themselves among them.
    pub passed: u64,
    /// Tests that failed.
    pub failed: u64,
    /// Tests marked `#[ignore]`.
    pub ignored: u64,
    /// Tests that no filter asked for.
    pub filtered_out: u64,
    /// Binaries that began and gave no result: they crashed or were killed.
    pub unfinished: u64,
    is_running: bool,
}

impl Totals {
    /// Takes in one line of output.
    pub fn read_line(&mut self, line: &str) {
        if is_start(line) {
            self.finish();
            self.is_running = true;
        } else if let Some(counts) = line.strip_prefix("test result: ") {
            self.is_running = false;
            self.passed += count(counts, "passed");
            self.failed += count(counts, "failed");
            self.ignored += count(counts, "ignored");
            self.filtered_out += count(counts, "filtered out");
        }
    }

    /// Takes in the end of the output.
    pub fn finish(&mut self) {
        self.unfinished += u64::from(self.is_running);
        self.is_running = false;
    }

    /// Tests that ran to a result.
    pub fn num_ran(&self) -> u64 {
        self.passed + self.failed
    }
}

/// Whether a line is `running N tests`.
fn is_start(line: &str) -> bool {
    let words: Vec<_> = line.split_whitespace().collect();
    matches!(words.as_slice(), ["running", number, "test" | "tests"] if number.parse::<u64>().is_ok())
}

/// The number before `word` in `ok. 3 passed; 0 failed; …`; zero where the word is absent.
fn count(counts: &str, word: &str) -> u64 {
    counts
        .split(';')
        .filter_map(|part| part.trim().strip_suffix(word))
        .filter_map(|rest| rest.split_whitespace().next_back()?.parse::<u64>().ok())
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn totals(output: &str) -> Totals {
        let mut totals = Totals::default();
        output.lines().for_each(|line| totals.read_line(line));
        totals.finish();
        totals
    }

    #[test]
    fn one_result_line_is_read_whole() {
        let line = "test result: FAILED. 12 passed; 3 failed; 4 ignored; 0 measured; 5 filtered out; finished in 1.20s";
        let expected = Totals { passed: 12, failed: 3, ignored: 4, filtered_out: 5, ..Totals::default() };
        assert_eq!(totals(line), expected);
    }

    #[test]
    fn binaries_and_doc_tests_add_up() {
        let output = "\nrunning 1 test\ntest tests::one ... ok\n\n\
            test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s\n\n\
            \nrunning 2 tests\ntest src/lib.rs - doc (line 3) ... ok\n\
            test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.31s\n\n\
            all doctests ran in 0.50s; merged doctests compilation took 0.18s\n";
        assert_eq!(totals(output), Totals { passed: 3, ..Totals::default() });
    }

    #[test]
    fn a_binary_without_a_result_is_noticed_in_the_middle_and_at_the_end() {
        let ok = "test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out";
        let output = format!("running 3 tests\ntest a ... ok\nrunning 1 test\n{ok}\nrunning 2 tests\n");
        assert_eq!(totals(&output), Totals { passed: 1, unfinished: 2, ..Totals::default() });
    }

    #[test]
    fn other_lines_count_nothing() {
        let output = "test tests::passed ... ok\nrunning late\nrunning many tests\n3 passed; 4 failed\n\
            failures:\n    tests::failed\nnote: test result: ok. 5 passed; 0 failed\n";
        assert_eq!(totals(output), Totals::default());
    }
}

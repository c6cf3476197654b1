// Below each result of the search, the sentence around the first hit in the page, with a link to its section. excerpts_data.js has the texts:
// {page: [[anchor, heading, text], ...]}.
document.addEventListener("DOMContentLoaded", () => {
  const LONGEST = 280;  // characters of an excerpt
  const query = new URLSearchParams(window.location.search).get("q") || "";
  const words = splitQuery(query.toLowerCase()).filter((word) => !stopwords.includes(word));
  const patterns = words.map((word) => [word, new Stemmer().stemWord(word)]);

  /** Place and length of a word in a text: the word itself, otherwise what has its stem; null where there is none. */
  function find(text, [word, stem]) {
    const lower = text.toLowerCase();
    const whole = lower.search(new RegExp(`(?<![\\p{L}\\p{N}])${word}(?![\\p{L}\\p{N}])`, "u"));
    if (whole >= 0) return [whole, word.length];
    for (const part of [word, stem]) if (lower.includes(part)) return [lower.indexOf(part), part.length];
    return null;
  }

  /** The section with the most of the words, the first of these; null where none has any. */
  function bestSection(sections) {
    let best = null, most = 0;
    for (const section of sections) {
      const count = patterns.filter((pattern) => find(section[2], pattern)).length;
      if (count > most) [best, most] = [section, count];
    }
    return best;
  }

  /** The sentence around a place, shortened to LONGEST. */
  function sentence(text, place, length) {
    let begin = Math.max(...[". ", "! ", "? ", ": "].map((end) => text.lastIndexOf(end, place - 1) + 1));
    const ends = [". ", "! ", "? "].map((end) => text.indexOf(end, place + length)).filter((i) => i >= 0);
    let end = ends.length ? Math.min(...ends) + 1 : text.length;
    if (place + length - begin > LONGEST - 40) begin = text.indexOf(" ", place - LONGEST / 2);
    if (end - begin > LONGEST) end = Math.max(place + length, text.lastIndexOf(" ", begin + LONGEST));
    const open = begin > 0 && !/[.!?:] ?$/.test(text.slice(0, begin));
    return (open ? "... " : "") + text.slice(begin, end).trim() + (end < text.length && !/[.!?]$/.test(text.slice(0, end)) ? " ..." : "");
  }

  /** The text with the words in <strong>. */
  function appendMarked(element, text) {
    const any = words.map((word, i) => `${word}|${patterns[i][1]}[\\p{L}\\p{N}]*`).join("|");
    text.split(new RegExp(`(${any})`, "giu")).forEach((part, i) => {
      if (i % 2) element.appendChild(document.createElement("strong")).textContent = part;
      else element.append(part);
    });
  }

  function addExcerpt(item) {
    const link = item.querySelector("a");
    const [page, anchor] = link.getAttribute("href").split("?")[0].split("#");
    const sections = window.slomExcerpts[page.replace(/\.html$/, "")] || [];
    const section = sections.find((each) => each[0] === anchor) || bestSection(sections);
    if (!section) return;
    const hits = patterns.map((pattern) => find(section[2], pattern)).filter((hit) => hit);
    const [place, length] = hits.length ? hits.reduce((a, b) => (b[0] < a[0] ? b : a)) : [0, 0];
    const paragraph = item.appendChild(document.createElement("p"));
    paragraph.className = "context";
    if (section !== sections[0] && !anchor) {
      const heading = paragraph.appendChild(document.createElement("a"));
      heading.href = `${page}#${section[0]}`;
      heading.textContent = section[1];
      paragraph.append(": ");
    }
    appendMarked(paragraph, sentence(section[2], place, length));
  }

  const results = document.querySelector("#search-results");
  if (!results || !words.length) return;
  const add = () => results.querySelectorAll("ul.search li:not([data-excerpt])").forEach((item) => {
    item.dataset.excerpt = "";
    addExcerpt(item);
  });
  new MutationObserver(add).observe(results, { childList: true, subtree: true });
  add();
});

// Ranks the sections of the index for a query. Used by site.js in the page, and by the tests in Node.js.
//
// A section is [address, title of its page, heading, part, text, terms that it explains]. The score is BM25, where a word in the title,
// the heading or the terms counts as several in the text. The last word of a query may be the beginning of a word; a plural matches its singular.
(() => {
  "use strict";

  const IN_TITLE = 6;
  const IN_HEADING = 8;
  const IN_TERMS = 4;
  /** BM25: saturation with the number of occurrences, and the effect of the length (of its root: tables of keys are long). */
  const SATURATION = 1.2;
  const LENGTH = 0.4;
  /** Weight of a word of which the query is only the beginning. */
  const BEGINNING = 0.6;
  /** Score of the last section that is shown, relative to the first. */
  const LEAST = 0.15;
  /** Weight of sections whose title and heading have all words of the query. */
  const NAMED = 1.5;
  /** Weights of pages that have many words, and are rarely what is meant: the list of changes, references of functions. */
  const weightOf = ([address, , , part]) => (part === "Project" ? 0.4 : address.startsWith("api/") ? 0.6 : 1);

  const words = (text) => text.toLowerCase().normalize("NFKD").replace(/\p{M}/gu, "").match(/[\p{L}\p{N}]+/gu) ?? [];

  /** Words with the same stem are the same word: plurals only, so that terms of the field stay apart. */
  const stem = (word) => {
    if (word.length > 4 && word.endsWith("ies")) return `${word.slice(0, -3)}y`;
    if (word.length > 3 && word.endsWith("s") && !/(ss|us|is)$/.test(word)) return word.slice(0, -1);
    return word;
  };

  /** Weighted count of each word in a section. */
  const counts = ([, title, heading, , text, terms]) => {
    const found = new Map();
    const add = (from, weight) => {
      for (const word of words(from)) found.set(stem(word), (found.get(stem(word)) ?? 0) + weight);
    };
    add(title, heading === "" ? IN_TITLE + IN_HEADING : IN_TITLE);
    add(heading, IN_HEADING);
    add(text, 1);
    add(terms, IN_TERMS);
    return found;
  };

  /** Prepares an index: for each word, the sections that have it. */
  const prepare = (sections) => {
    const postings = new Map();
    const lengths = sections.map((section, number) => {
      let length = 0;
      for (const [word, count] of counts(section)) {
        length += count;
        if (!postings.has(word)) postings.set(word, []);
        postings.get(word).push([number, count]);
      }
      return length;
    });
    const mean = lengths.reduce((sum, length) => sum + length, 0) / Math.max(1, lengths.length);
    const names = sections.map(([, title, heading]) => new Set(words(`${title} ${heading}`).map(stem)));
    return { sections, postings, lengths, mean, names };
  };

  /** Words of the index that match a word of the query, with a weight. */
  const matching = (index, word, isLast) => {
    const exact = stem(word);
    const found = index.postings.has(exact) ? [[exact, 1]] : [];
    if (isLast && word.length > 1) {
      for (const known of index.postings.keys()) {
        if (known !== exact && known.startsWith(word)) found.push([known, BEGINNING]);
      }
    }
    return found;
  };

  /** Scores of the sections for one word of the query. */
  const scores = (index, word, isLast) => {
    const best = new Map();
    for (const [known, weight] of matching(index, word, isLast)) {
      const all = index.postings.get(known);
      const rarity = Math.log(1 + (index.sections.length - all.length + 0.5) / (all.length + 0.5));
      for (const [number, count] of all) {
        const length = 1 - LENGTH + LENGTH * Math.sqrt(index.lengths[number] / index.mean);
        const score = (weight * rarity * count * (SATURATION + 1)) / (count + SATURATION * length);
        best.set(number, Math.max(best.get(number) ?? 0, score));
      }
    }
    return best;
  };

  /** Sections that have words of the query, best first. A section without one of them counts much less. */
  const search = (index, query, limit = 20) => {
    const asked = words(query);
    const totals = new Map();
    asked.forEach((word, at) => {
      for (const [number, score] of scores(index, word, at === asked.length - 1)) {
        const total = totals.get(number) ?? { found: 0, score: 0 };
        totals.set(number, { found: total.found + 1, score: total.score + score });
      }
    });
    const rank = ([number, { found, score }]) => {
      const isNamed = asked.every((word) => index.names[number].has(stem(word)));
      return [number, score * (found / asked.length) ** 3 * weightOf(index.sections[number]) * (isNamed ? NAMED : 1)];
    };
    const ranked = [...totals].map(rank).sort((a, b) => b[1] - a[1] || a[0] - b[0]);
    const least = (ranked[0]?.[1] ?? 0) * LEAST;
    const shown = ranked.filter(([, score]) => score > least).slice(0, limit);
    return shown.map(([number]) => index.sections[number]);
  };

  /** The part of a text around the first word of the query, as pieces: [text, is it a word of the query]. */
  const excerpt = (text, query, length = 170) => {
    const asked = words(query).map(stem);
    const isAsked = (piece) => {
      const [word] = words(piece);
      return word !== undefined && asked.some((one) => stem(word) === one || (one.length > 2 && word.startsWith(one)));
    };
    const pieces = text.split(/(?<=[^\p{L}\p{N}])(?=[\p{L}\p{N}])|(?<=[\p{L}\p{N}])(?=[^\p{L}\p{N}])/u);
    let at = 0;
    const first = pieces.findIndex(isAsked);
    let start = Math.max(0, first);
    for (let before = 0; start > 0 && before < length / 4; start -= 1) before += pieces[start - 1].length;
    const shown = start > 0 ? [["… ", false]] : [];
    for (const piece of pieces.slice(start)) {
      at += piece.length;
      if (at > length) return [...shown, [" …", false]];
      shown.push([piece, isAsked(piece)]);
    }
    return shown;
  };

  globalThis.papilioSearch = { prepare, search, excerpt };
})();

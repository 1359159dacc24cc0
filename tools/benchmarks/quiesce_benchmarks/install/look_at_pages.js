// What is wrong with a page in a window of that width, a line each. What scrolls in a box of its own
// may be wider; a plot's text is as large as its font under all scales between it and the screen.
width => {
  const wrong = [];
  const at = e => `${e.tagName.toLowerCase()} '${e.textContent.trim().slice(0, 40)}'`;
  const scrolls = e => /auto|scroll/.test(getComputedStyle(e).overflowX);
  const isBoxed = e => e.parentElement && (scrolls(e.parentElement) || isBoxed(e.parentElement));
  const hasKeys = e => e.tabIndex === 0 && e.getAttribute('role') === 'region' && e.ariaLabel;

  if (document.documentElement.scrollWidth > width) wrong.push('the page scrolls sideways');
  for (const e of document.body.querySelectorAll('*')) {
    const box = e.getBoundingClientRect();
    if ((box.right > width + 0.5 || box.left < -0.5) && !isBoxed(e)) wrong.push(`too wide: ${at(e)}`);
    if (scrolls(e) && e.scrollWidth > e.clientWidth && !hasKeys(e)) wrong.push(`no keys: ${at(e)}`);
  }
  for (const cell of document.querySelectorAll('th, td')) {
    const box = cell.getBoundingClientRect(), text = document.createRange();
    text.selectNodeContents(cell);
    const ink = text.getBoundingClientRect();
    const isOut = ink.left < box.left - 1 || ink.right > box.right + 1 || ink.bottom > box.bottom + 1;
    const isCut = !isBoxed(cell) || /hidden|clip/.test(getComputedStyle(cell).overflowX);
    if (ink.width && (isOut || isCut)) wrong.push(`clipped: ${at(cell)}`);
  }
  if (document.querySelector('main img')) wrong.push('a picture whose text cannot be measured');
  for (const svg of document.querySelectorAll('main svg')) {
    if (!svg.querySelector('text')) wrong.push('a plot without text');
    for (const text of svg.querySelectorAll('text, tspan')) {
      const m = text.getScreenCTM(), scale = Math.sqrt(Math.abs(m.a * m.d - m.b * m.c));
      const size = scale * parseFloat(getComputedStyle(text).fontSize);
      if (text.textContent.trim() && size < 11) wrong.push(`${size.toFixed(1)} px: ${at(text)}`);
    }
  }
  const ids = [...document.querySelectorAll('[id]')].map(e => e.id);
  if (new Set(ids).size < ids.length) wrong.push('an id stands twice');
  return wrong;
}

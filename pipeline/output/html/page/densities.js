// Shows the density that is chosen from the list.
'use strict';

(() => {
  const pictures = JSON.parse(document.getElementById('density-data').textContent);
  const chosen = document.getElementById('density-of');
  const show = () => { document.getElementById('density').innerHTML = pictures[chosen.selectedIndex]; };
  chosen.addEventListener('input', show);
  show();  // the browser keeps a choice when it goes back to a page
})();
